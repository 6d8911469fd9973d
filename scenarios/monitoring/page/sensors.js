import { cut, element, finite } from "./words.js";

const shown = 200;  // rows of the table
const most = 20000; // sensors that are kept
const order = { active: 0, unknown: 1, clear: 2 };

/// The table of sensors: health, alarm and settings of each. Of many, the most serious ones are shown, or those that are asked for.
export class Sensors {
  constructor(body, note, filter, alarms) {
    Object.assign(this, { body, note, filter, alarms });
    this.sensors = new Map(); // by id (text): { health, config, ack }
  }

  get(id) {
    if (!this.sensors.has(id)) {
      if (this.sensors.size >= most) return {};
      this.sensors.set(id, {});
    }
    return this.sensors.get(id);
  }

  takeHealth(list) {
    if (!Array.isArray(list)) return;
    for (const h of list.slice(0, most)) if (h && (typeof h.id === "number" || typeof h.id === "string")) this.get(String(h.id)).health = h;
  }

  /// Ids in the order of the table.
  listed() {
    const asked = this.filter.value.trim();
    const ids = [...this.sensors.keys()].filter((id) => !asked || id.includes(asked));
    const rank = new Map(ids.map((id) => [id, order[this.alarms.state(`sensor ${id}`)]]));
    return ids.sort((a, b) => rank.get(a) - rank.get(b) || a - b || (a < b ? -1 : 1));
  }

  show() {
    const ids = this.listed(), rows = [];
    for (const id of ids.slice(0, shown)) {
      const { health: h = {}, config, ack } = this.sensors.get(id), row = document.createElement("tr");
      const acknowledged = config && ack && ack.revision === config.revision, number = (n) => (finite(n) ? String(n) : "unknown");
      for (const text of [cut(id, 40), this.alarms.state(`sensor ${id}`), h.status === undefined ? "unknown" : cut(h.status, 20), number(h.samples),
        number(h.missing), number(h.duplicates), number(h.refused), finite(h.battery) ? h.battery.toFixed(2) : "unknown",
        config ? `${cut(config.rate_hz, 12)} Hz, ${cut(config.strategy, 20)}, ${acknowledged ? "acknowledged" : "not acknowledged yet"}` : "as delivered"])
        row.append(element("td", text));
      row.dataset.state = this.alarms.state(`sensor ${id}`);
      rows.push(row);
    }
    this.body.replaceChildren(...rows);
    this.note.textContent = ids.length > shown ? `${shown} of ${ids.length} sensors are shown, the most serious ones first; find others by their id.` : "";
  }
}
