import { cut, element } from "./words.js";

const shown = 100;  // alarms in the list
const most = 20000; // that are kept
const states = ["active", "clear", "unknown"];

/// Alarms of sensors and of models. An alarm of a run that is not alive is unknown, whatever it was.
export class Alarms {
  constructor(parent, counts, runs) {
    Object.assign(this, { parent, counts, runs });
    this.alarms = new Map(); // by key, "sensor 3" or "agreement": { name, sensor, alarm }
  }

  take(key, name, sensor, content) {
    if (!this.alarms.has(key) && this.alarms.size >= most) return;
    this.alarms.set(key, { name, sensor, state: states.includes(content.state) ? content.state : "unknown",
      verdict: cut(content.verdict, 80), reason: cut(content.reason), run: cut(content.run, 80) });
  }

  stateOf(alarm) { return this.runs.alive(alarm.run) ? alarm.state : "unknown"; }
  state(key) { const alarm = this.alarms.get(key); return alarm ? this.stateOf(alarm) : "unknown"; }

  show() {
    const by = { active: [], unknown: [], clear: [] };
    for (const alarm of this.alarms.values()) by[this.stateOf(alarm)].push(alarm);
    const text = this.alarms.size ? `${by.active.length} active, ${by.unknown.length} unknown, ${by.clear.length} clear` : "unknown: nothing was judged yet";
    if (this.counts.textContent !== text) this.counts.textContent = text;
    const listed = [...by.active, ...by.unknown, ...by.clear], items = [];
    for (const alarm of listed.slice(0, shown)) {
      const state = this.stateOf(alarm), dead = !this.runs.alive(alarm.run);
      const item = element("li", `${cut(alarm.name, 40)}: ${dead && alarm.state !== "unknown" ? `unknown; was ${alarm.state}, ${alarm.verdict}` : alarm.verdict}`,
        state === "active" ? "alarm" : state);
      if (alarm.sensor !== null) item.dataset.sensor = cut(alarm.sensor, 40);
      item.dataset.state = state;
      if (alarm.reason) item.append(element("span", ` ${alarm.reason}`));
      items.push(item);
    }
    if (listed.length > shown) items.push(element("li", `and ${listed.length - shown} more`, "note"));
    const signature = items.map((i) => i.className + i.textContent).join("\n");
    if (signature === this.signature) return; // a screen reader reads every change
    this.signature = signature;
    this.parent.replaceChildren(...items);
  }

  /// Ids of sensors with an active alarm.
  active() { return [...this.alarms.values()].filter((a) => a.sensor !== null && this.stateOf(a) === "active").map((a) => a.sensor); }
}
