import uPlot from "uplot";
import { cut, finite } from "./words.js";

const longest = 4000;     // points of a curve; of more, those that stand out are kept
const mostNumbers = 2e6;  // of all curves of all sensors
const mostSensors = 10000;
const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

/// Rows of numbers over the first one. When there are too many, of every four the two are kept that have the least and the largest
/// value, so that what stands out remains.
class Series {
  constructor(names) { this.names = names; this.rows = []; }

  add(content, most) {
    const row = this.names.map((name) => (finite(content[name], 1e15) ? content[name] : null));
    if (row[0] === null) return;
    if (this.rows.length && row[0] < this.rows[this.rows.length - 1][0]) this.rows = []; // it began again
    this.rows.push(row);
    if (this.rows.length > most) this.thin();
  }

  thin() {
    const kept = [];
    for (let k = 0; k < this.rows.length; k += 4) {
      const four = this.rows.slice(k, k + 4).map((row, place) => ({ row, place }));
      const value = ({ row }) => row[1] ?? row[2] ?? 0;
      const sorted = [...four].sort((a, b) => value(a) - value(b) || a.place - b.place);
      const two = sorted.length > 2 ? [sorted[0], sorted[sorted.length - 1]] : sorted;
      kept.push(...two.sort((a, b) => a.place - b.place).map(({ row }) => row));
    }
    this.rows = kept;
  }
}

/// Curves as the table of published numbers (bris/numbers) says; the page itself knows no names.
export class Curves {
  constructor(parent) {
    this.parent = parent;
    this.specs = [];  // { title, axis, over, lines, topic, plot }
    this.series = new Map(); // by topic
    this.sensor = null;      // whose curves are shown
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => { this.unmake(); this.schedule(); });
    new ResizeObserver(() => this.specs.forEach((s) => s.plot?.setSize(this.size()))).observe(parent);
  }

  size() { return { width: Math.max(200, this.parent.clientWidth), height: 190 }; }

  /// The table: which numbers each message has, and how they are drawn.
  table({ curves }) {
    if (!Array.isArray(curves)) return;
    const text = (value, most) => cut(typeof value === "string" ? value : "", most);
    const specs = curves.slice(0, 20).map((c) => ({ title: text(c.title, 80), axis: text(c.axis, 80), topic: text(c.topic, 80),
      over: text(c.over, 80), factor: finite(c.factor) ? c.factor : 1, axisFactor: finite(c.axis_factor) ? c.axis_factor : 1,
      lines: (Array.isArray(c.lines) ? c.lines : []).slice(0, 4).map((l) => ({ name: text(l.name, 80), label: text(l.label, 80), half: text(l.half_width, 80) })) }));
    const signature = JSON.stringify(specs);
    if (signature === this.signature) return;
    this.signature = signature;
    this.unmake();
    this.specs = specs;
    this.series.clear();
    this.early?.forEach(([topic, content]) => this.add(topic, content));
    this.early = null;
  }

  /// A message. `topic` as in the table, but for the id of a sensor.
  add(topic, content) {
    if (!content || typeof content !== "object") return;
    if (!this.specs.length) { // the table is still to come
      this.early = [...(this.early ?? []).slice(-200), [topic, content]];
      return;
    }
    const kind = topic.startsWith("bris/sensor/") ? "bris/sensor/ID" : topic;
    const names = [];
    for (const s of this.specs) if (s.topic === kind) for (const n of [s.over, ...s.lines.flatMap((l) => [l.name, l.half])]) if (n && !names.includes(n)) names.push(n);
    if (!names.length || (!this.series.has(topic) && this.series.size >= mostSensors)) return;
    if (!this.series.has(topic)) this.series.set(topic, new Series(names));
    this.series.get(topic).add(content, Math.max(64, Math.min(longest, mostNumbers / names.length / this.series.size)));
    this.schedule();
  }

  schedule() {
    this.due ??= requestAnimationFrame(() => { this.due = undefined; this.draw(); });
  }

  /// Shows the curves of a sensor; null: of the first one that has any.
  choose(sensor) { this.sensor = sensor; this.schedule(); }
  topicOf(spec) {
    if (spec.topic !== "bris/sensor/ID") return spec.topic;
    if (this.sensor !== null && this.series.has(`bris/sensor/${this.sensor}`)) return `bris/sensor/${this.sensor}`;
    for (const topic of this.series.keys()) if (topic.startsWith("bris/sensor/")) return topic;
    return "";
  }

  unmake() { for (const s of this.specs) { s.plot?.destroy(); s.plot = null; } }

  make(spec) {
    const line = colour("--line"), text = colour("--text"), accent = colour("--accent");
    const axis = { stroke: text, grid: { stroke: line }, ticks: { stroke: line } };
    const strokes = [{ stroke: accent, width: 2 }, { stroke: text, dash: [5, 4] }, { stroke: colour("--soft"), width: 1, dash: [1, 3] }, { stroke: text }];
    const series = [{ label: spec.axis }], bands = [];
    spec.lines.forEach((l, k) => {
      series.push({ label: l.label, spanGaps: true, points: { size: 4 }, ...strokes[k % strokes.length] });
      if (!l.half) return;
      const edge = { stroke: "transparent", points: { show: false }, class: "edge" };
      series.push({ ...edge, label: "above" }, { ...edge, label: "below" });
      bands.push({ series: [series.length - 2, series.length - 1], fill: accent + "40" });
    });
    spec.plot = new uPlot({ ...this.size(), title: spec.title, scales: { x: { time: false } }, axes: [{ ...axis, label: spec.axis, labelSize: 18 }, axis],
      series, bands, legend: { live: false }, cursor: { show: false } }, series.map(() => []), this.parent);
  }

  /// Numbers of a spec as drawn: x, and for each line its values and the edges of its band.
  data(spec) {
    const series = this.series.get(this.topicOf(spec));
    if (!series) return null;
    const at = (name) => series.names.indexOf(name), column = (of) => series.rows.map(of);
    const x = column((r) => spec.axisFactor * r[at(spec.over)]), columns = [x];
    for (const l of spec.lines) {
      const k = at(l.name), h = at(l.half), value = (v) => (v === null ? null : spec.factor * v);
      columns.push(column((r) => value(r[k])));
      if (l.half) for (const sign of [1, -1]) columns.push(column((r) => (r[k] === null || r[h] === null ? null : value(r[k] + sign * r[h]))));
    }
    return columns;
  }

  draw() {
    for (const spec of this.specs) {
      const data = this.data(spec);
      if (!data) continue; // nothing was published
      if (!spec.plot) this.make(spec);
      spec.plot.setData(data);
    }
  }
}
