import mqtt from "mqtt/dist/mqtt.esm";
import { Curves } from "./curves.js";
import { Rocks } from "./rocks.js";

const at = (id) => document.getElementById(id);
const text = new TextDecoder();
const rocks = new Rocks(at("rocks"));
const curves = new Curves(at("curves"));
const sensors = new Map(); // by id: { health, config, ack, alarm }
const longest = 8 << 20;   // characters of a payload that is read
let client = null, revision = 0;

const sensor = (id) => {
  if (!sensors.has(id)) sensors.set(id, {});
  return sensors.get(id);
};

const cell = (row, content) => { row.insertCell().textContent = content; };

function showSensors() {
  const body = at("sensors"), chosen = at("config-sensor");
  const ids = [...sensors.keys()].sort((a, b) => a - b);
  body.replaceChildren();
  for (const id of ids) {
    const { health: h = {}, config, ack } = sensors.get(id), row = body.insertRow();
    const acknowledged = config && ack && ack.revision === config.revision;
    cell(row, id); cell(row, h.status ?? "unknown"); cell(row, h.samples ?? 0);
    cell(row, h.missing ?? 0); cell(row, h.duplicates ?? 0); cell(row, h.refused ?? 0);
    cell(row, h.battery == null ? "unknown" : h.battery.toFixed(2));
    cell(row, config ? `${config.rate_hz} Hz, ${config.strategy}, ` +
      (acknowledged ? "acknowledged" : "not acknowledged yet") : "as delivered");
  }
  if (chosen.options.length !== ids.length) {
    const before = chosen.value;
    chosen.replaceChildren(...ids.map((id) => new Option(`sensor ${id}`, id)));
    if (before) chosen.value = before;
  }
}

function showAlarms() {
  const active = [...sensors].filter(([, s]) => s.alarm && s.alarm.active).sort((a, b) => a[0] - b[0]);
  at("alarms").replaceChildren(...(active.length ? active : [null]).map((entry) => {
    const item = document.createElement("li");
    if (!entry) { item.className = "note"; item.textContent = "none"; return item; }
    item.className = "alarm";
    item.dataset.sensor = entry[0];
    item.textContent = `Sensor ${entry[0]}: ${entry[1].alarm.verdict}. `;
    const reason = document.createElement("span");
    reason.textContent = entry[1].alarm.reason;
    item.append(reason);
    return item;
  }));
  rocks.alarm(new Set(active.map(([id]) => id)));
}

function showHealth(report) {
  for (const h of report.sensors ?? []) sensor(h.id).health = h;
  at("health").textContent = `${report.messages} messages, ${report.machine_records} records of the ` +
    `test machine, ${report.breaks} breaks of the model's connection, ${report.dropped} dropped`;
}

const retained = { alarm: showAlarms, config: showSensors, "config/ack": showSensors };

function take(topic, payload) {
  if (payload.length > longest) return;
  if (topic.startsWith("bris/poses/")) {
    const count = rocks.poses(payload);
    if (count !== null) at("rocks-state").textContent = `${count.bodies} rocks at ${count.time.toPrecision(4)}`;
    return;
  }
  const content = JSON.parse(text.decode(payload));
  if (topic === "bris/scene") {
    at("title").textContent = content.title;
    rocks.scene(content);
  } else if (topic === "bris/state") curves.add(content);
  else if (topic === "bris/health") { showHealth(content); showSensors(); }
  else {
    const [, id, what] = /^smartrock\/(\d+)\/(alarm|config|config\/ack)$/.exec(topic) ?? [];
    if (!id) return;
    sensor(+id)[{ alarm: "alarm", config: "config", "config/ack": "ack" }[what]] = content;
    retained[what]();
    if (what === "config/ack") at("config-state").textContent =
      `sensor ${id}: ${content.accepted ? "acknowledged" : "refused: " + content.reason}`;
  }
}

function state(name, words) {
  at("connection").dataset.state = name;
  at("connection").textContent = words;
}

function connect(address, username, password) {
  if (client) client.end(true);
  client = mqtt.connect(address, { protocolVersion: 5, reconnectPeriod: 1000, connectTimeout: 5000,
    clean: true, username: username || undefined, password: password || undefined,
    properties: { maximumPacketSize: longest } });
  client.on("connect", () => {
    state("connected", "connected");
    at("login").hidden = true;
    client.subscribe(["bris/#", "smartrock/+/alarm", "smartrock/+/config", "smartrock/+/config/ack"], { qos: 1 });
  });
  client.on("close", () => state("broken", "no connection; trying again"));
  client.on("error", (error) => {
    state("broken", error.message);
    if (/not authori[sz]ed|bad user/i.test(error.message)) { client.end(true); at("login").hidden = false; }
  });
  client.on("message", (topic, payload) => {
    try { take(topic, payload); } catch (error) { console.warn(topic, error.message); }
  });
}

at("settings").addEventListener("submit", (event) => {
  event.preventDefault();
  const id = at("config-sensor").value;
  if (!client || id === "") return;
  revision = Math.max(revision + 1, Date.now());
  client.publish(`smartrock/${id}/config`, JSON.stringify({ revision, rate_hz: +at("config-rate").value,
    strategy: at("config-strategy").value, threshold: +at("config-threshold").value }), { qos: 1, retain: true });
  at("config-state").textContent = `sensor ${id}: sent, not acknowledged yet`;
});
at("only-sensors").addEventListener("change", (event) => rocks.only(event.target.checked));
at("login").addEventListener("submit", (event) => {
  event.preventDefault();
  connect(at("address").value, at("user").value, at("password").value);
});

// ?broker=ws://HOST:PORT, else where the page comes from, else asked for
const asked = new URLSearchParams(location.search).get("broker");
const origin = location.protocol.startsWith("http") ? location.origin.replace(/^http/, "ws") : "";
const address = asked && /^wss?:\/\//.test(asked) ? asked : origin;
at("address").value = address || "ws://127.0.0.1:9001";
if (address) connect(address);
else { state("waiting", "which broker?"); at("login").hidden = false; }
window.bris = { rocks, curves, sensors, connect }; // for tests and the console
