import uPlot from "uplot";

const most = 20000; // points that are kept
const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

/// What is drawn over the axial strain: title, model, measured, deviation, factor.
const wanted = [
  { title: "Deviatoric stress (kPa)", model: "q_Pa", measured: "measured_q_Pa", factor: 1e-3 },
  { title: "Volumetric strain (%)", model: "volumetric_strain", measured: "measured_volumetric_strain", factor: 100 },
  { title: "Friction coefficient", model: "friction", deviation: "friction_deviation", factor: 1 },
  { title: "Stiffness ratio", model: "stiffness_ratio", deviation: "stiffness_ratio_deviation", factor: 1 },
];

export class Curves {
  constructor(parent) {
    this.parent = parent;
    this.rows = [];
    this.plots = [];
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => { this.make(); this.draw(); });
    new ResizeObserver(() => this.plots.forEach((p) => p.setSize(this.size()))).observe(parent);
  }

  size() { return { width: Math.max(200, this.parent.clientWidth), height: 170 }; }

  add(state) {
    if (typeof state.axial_strain !== "number") return;
    if (this.rows.length && state.axial_strain < this.rows[this.rows.length - 1].axial_strain) this.rows = []; // anew
    this.rows.push(state);
    if (this.rows.length > most) this.rows.splice(0, most / 10);
    if (!this.plots.length) this.make();
    this.due ??= requestAnimationFrame(() => { this.due = undefined; this.draw(); });
  }

  make() {
    this.plots.forEach((p) => p.destroy());
    const line = colour("--line"), text = colour("--text"), accent = colour("--accent");
    const axis = { stroke: text, grid: { stroke: line }, ticks: { stroke: line } };
    this.plots = wanted.map((w) => new uPlot({
      ...this.size(), title: w.title, scales: { x: { time: false } },
      axes: [{ ...axis, label: "axial strain (%)", labelSize: 18 }, axis],
      series: [{ label: "%" }, { label: "model", stroke: accent, width: 2 },
        ...(w.deviation ? [{ label: "above", stroke: "transparent" }, { label: "below", stroke: "transparent" }]
          : [{ label: "measured", stroke: text, dash: [5, 4], spanGaps: true }])],
      bands: w.deviation ? [{ series: [2, 3], fill: accent + "40" }] : [],
      legend: { show: false },
    }, [[], [], [], ...(w.deviation ? [[]] : [])], this.parent));
  }

  draw() {
    const x = this.rows.map((r) => 100 * r.axial_strain);
    this.plots.forEach((plot, k) => {
      const { model, measured, deviation, factor } = wanted[k];
      const column = (of) => this.rows.map((r) => { const v = of(r); return Number.isFinite(v) ? factor * v : null; });
      plot.setData(deviation
        ? [x, column((r) => r[model]), column((r) => r[model] + r[deviation]), column((r) => r[model] - r[deviation])]
        : [x, column((r) => r[model]), column((r) => r[measured] ?? null)]);
    });
  }
}
