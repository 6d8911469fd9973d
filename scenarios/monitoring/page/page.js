import mqtt from "mqtt/dist/mqtt.esm";
import { Alarms } from "./alarms.js";
import { Curves } from "./curves.js";
import { Rocks } from "./rocks.js";
import { Runs } from "./runs.js";
import { Sensors } from "./sensors.js";
import { cut, element, finite, span } from "./words.js";

const at = (id) => document.getElementById(id);
const text = new TextDecoder();
const longest = 8 << 20; // characters of a payload that is read
const rocks = new Rocks(at("rocks")), curves = new Curves(at("curves")), runs = new Runs();
const alarms = new Alarms(at("alarms"), at("alarm-counts"), runs);
const sensors = new Sensors(at("sensors"), at("sensors-note"), at("find-sensor"), alarms);
let client = null, revision = 0, lag = null;

function showRuns() {
  const found = [...runs.runs.keys()].sort().map((name) => ({ name, ...runs.describe(name) }));
  at("runs").replaceChildren(...found.map(({ name, kind, text: words }) => {
    const item = element("li", `${name}: ${words}`);
    item.dataset.kind = kind;
    return item;
  }));
  const stale = runs.stale();
  at("stale").hidden = !stale;
  if (stale && at("stale").textContent !== stale.text) at("stale").textContent = stale.text;
  at("stale").dataset.kind = document.body.dataset.stale = stale ? stale.kind : "";
  at("lag").textContent = lag === null ? "lag: unknown" : `lag: the model answered the last record ${lag < 10 ? lag.toFixed(2) : lag.toFixed(0)} s after its arrival`;
}

/// All that depends on messages and on time; at most a few times a second, however many messages come.
function show() {
  showRuns();
  alarms.show();
  const active = alarms.active();
  rocks.alarm(new Set(active.map(Number)));
  if (show.sensors) { show.sensors = false; sensors.show(); }
  const hasSensorCurves = [...curves.series.keys()].some((topic) => topic.startsWith("bris/sensor/"));
  at("curve-sensor-label").hidden = !hasSensorCurves;
}
function schedule(ofSensors = false) {
  show.sensors ||= ofSensors;
  schedule.due ??= setTimeout(() => { schedule.due = undefined; show(); }, sensors.sensors.size > 500 ? 1000 : 100);
}
setInterval(() => schedule(true), 1000); // what is alive changes with time

function takeHealth(h) {
  sensors.takeHealth(h.sensors);
  const number = (n) => (finite(n) ? n : "unknown");
  at("health").textContent = `${number(h.messages)} messages, ${number(h.machine_records)} records of the test machine, ` +
    `${number(h.breaks)} breaks of the model's connection, ${number(h.dropped)} dropped`;
  if (!at("config-sensor").value && sensors.sensors.size) at("config-sensor").value = cut(sensors.listed()[0], 10);
}

const ofSensor = {
  alarm: (id, content) => alarms.take(`sensor ${id}`, `Sensor ${id}`, id, content),
  config: (id, content) => { sensors.get(id).config = content; },
  "config/ack": (id, content) => {
    sensors.get(id).ack = content;
    at("config-state").textContent = `sensor ${cut(id, 40)}: ${content.accepted === true ? "acknowledged" : "refused: " + cut(content.reason)}`;
  },
};

function take(topic, payload, retained) {
  if (payload.length > longest) return;
  if (topic.startsWith("bris/poses/")) {
    const count = rocks.poses(payload);
    if (count !== null) at("rocks-state").textContent = `${count.bodies} rocks at ${count.time.toPrecision(4)}`;
    return;
  }
  const content = JSON.parse(text.decode(payload));
  if (content === null || typeof content !== "object") return;
  const [, run, will] = /^bris\/run\/([^/]{1,80})(\/gone)?$/.exec(topic) ?? [];
  const [, id, what] = /^smartrock\/([^/]+)\/(alarm|config|config\/ack)$/.exec(topic) ?? [];
  if (run) runs.take(cut(run, 80), !!will, content, retained);
  else if (id) ofSensor[what](id, content);
  else if (topic.startsWith("bris/alarm/")) alarms.take(topic, cut(topic.slice(11), 40), null, content);
  else if (topic === "bris/scene") {
    at("title").textContent = cut(content.title, 100);
    rocks.scene(content);
  } else if (topic === "bris/numbers") curves.table(content);
  else if (topic === "bris/health") takeHealth(content);
  else {
    if (topic === "bris/timing") lag = finite(content.latency_s) ? content.latency_s : null;
    curves.add(topic, content);
    return;
  }
  schedule(!run);
}

function state(name, words) {
  at("connection").dataset.state = name;
  at("connection").textContent = words;
  runs.connect(name === "connected");
  schedule();
}

function connect(address, username, password) {
  if (client) client.end(true);
  client = mqtt.connect(address, { protocolVersion: 5, reconnectPeriod: 1000, connectTimeout: 5000, timerVariant: "native",
    clean: true, username: username || undefined, password: password || undefined,
    properties: { maximumPacketSize: longest } });
  client.on("connect", () => {
    state("connected", "connected");
    at("login").hidden = true;
    client.subscribe(["bris/#", "smartrock/+/alarm", "smartrock/+/config", "smartrock/+/config/ack"], { qos: 1 });
  });
  client.on("close", () => { if (at("connection").dataset.state !== "broken") state("broken", "no connection; trying again"); });
  client.on("error", (error) => {
    state("broken", cut(error.message));
    if (/not authori[sz]ed|bad user/i.test(error.message)) { client.end(true); at("login").hidden = false; }
  });
  client.on("message", (topic, payload, packet) => {
    try { take(topic, payload, packet.retain === true); } catch (error) { console.warn(cut(topic, 80), cut(error.message)); }
  });
}

at("settings").addEventListener("submit", (event) => {
  event.preventDefault();
  const id = at("config-sensor").value;
  if (!client || !/^[0-9]{1,10}$/.test(id)) return;
  revision = Math.max(revision + 1, Date.now());
  client.publish(`smartrock/${id}/config`, JSON.stringify({ revision, rate_hz: +at("config-rate").value,
    strategy: at("config-strategy").value, threshold: +at("config-threshold").value }), { qos: 1, retain: true });
  at("config-state").textContent = `sensor ${id}: sent, not acknowledged yet`;
});
at("only-sensors").addEventListener("change", (event) => rocks.only(event.target.checked));
at("find-sensor").addEventListener("input", () => schedule(true));
at("curve-sensor").addEventListener("input", (event) => curves.choose(event.target.value.trim() || null));

// The broker is the server that the page comes from, whatever the URL says; a page that is opened from disk asks for a port of this
// computer. Others are refused by the Content-Security-Policy, too.
const served = location.protocol === "http:" || location.protocol === "https:";
const origin = served ? location.origin.replace(/^http/, "ws") : null;
at("address-label").hidden = served;
at("address-text").textContent = served ? `for the broker ${origin}` +
  (origin.startsWith("ws:") && !/^ws:\/\/(127\.0\.0\.1|localhost|\[::1\])(:|$)/.test(origin) ? "; a password goes there without encryption" : "") : "";
at("login").addEventListener("submit", (event) => {
  event.preventDefault();
  const address = origin ?? at("address").value;
  if (/^ws:\/\/(127\.0\.0\.1|localhost)(:\d+)?\/?$/.test(address) || address === origin) connect(address, at("user").value, at("password").value);
  else state("broken", "expected ws://127.0.0.1:PORT");
  at("password").value = "";
});
if (origin) connect(origin);
else { state("waiting", "which broker?"); at("login").hidden = false; }
window.bris = { rocks, curves, sensors, alarms, runs, take, span }; // for tests and the console
