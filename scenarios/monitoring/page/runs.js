import { clock, cut, finite, span } from "./words.js";

const silence = 5000;  // ms without a heartbeat after which a run is no longer alive
const first = 3000;    // ms in which a run that is alive gives a sign to a new page
const skew = 5;        // s by which clocks may differ without a word
const quiet = 30;      // s without a sign of the computation that are worth a word
const most = 50;       // runs that are kept

/// The runs that publish, and whether they are alive. Ages are measured from the arrival of heartbeats by the monotonic clock of
/// this computer; what the broker had kept was sent at an unknown time before, so that it proves no life, and its own time counts.
export class Runs {
  constructor() {
    this.runs = new Map();
    this.connected = null; // ms, when the broker began to send; null: it does not
  }

  connect(isConnected) {
    if (!isConnected && this.connected !== null) this.left = Date.now();
    this.connected = isConnected ? performance.now() : null;
  }

  /// A message of bris/run/NAME or bris/run/NAME/gone.
  take(name, isWill, content, retained) {
    if (!this.runs.has(name) && this.runs.size >= most) return;
    const run = this.runs.get(name) ?? {};
    this.runs.set(name, run);
    if (isWill) {
      run.gone = content.gone === true;
      run.goneAt = run.gone && !retained ? Date.now() : null;
      return;
    }
    run.beat = { state: cut(content.state, 20), time: finite(content.time, 1e11) ? content.time : null, doing: cut(content.doing),
      left: finite(content.left_s, 1e9) ? content.left_s : null, silent: finite(content.silent_s) ? content.silent_s : 0 };
    if (retained) return;
    run.heard = performance.now();
    run.heardAt = Date.now();
    run.gone = false;
    run.goneAt = null;
    if (run.beat.time !== null) run.ahead = Date.now() / 1000 - run.beat.time; // this clock, of that of the run
  }

  alive(name) {
    const run = this.runs.get(name);
    return this.connected !== null && !!run?.heard && !run.gone && run.beat?.state === "running" && performance.now() - run.heard < silence;
  }
  anyAlive() { return [...this.runs.keys()].some((name) => this.alive(name)); }

  /// Time (ms by this computer's clock) of the last sign of a run, and in words.
  last(run) {
    if (run.heardAt) return run.heardAt;
    return run.beat?.time != null ? 1000 * (run.beat.time + (run.ahead ?? 0)) : null;
  }
  since(run) {
    const at = run.goneAt ?? this.last(run);
    if (at === null) return "an unknown time";
    return `${clock(at)} (${span((Date.now() - at) / 1000)} ago${run.heardAt || run.goneAt ? "" : ", if its clock and this one agree"})`;
  }

  /// State of a run: alive, waiting, ended, gone, and a sentence.
  describe(name) {
    const run = this.runs.get(name), beat = run.beat;
    if (this.alive(name)) {
      const age = (performance.now() - run.heard) / 1000;
      let text = `running: ${beat.doing}`;
      if (beat.left !== null) text += `; until ${clock(run.heardAt + 1000 * beat.left)}, in ${span(beat.left - age)}`;
      if (beat.silent > quiet) text += `; no sign of its computation for ${span(beat.silent + age)}`;
      if (Math.abs(run.ahead ?? 0) > skew) text += `; its clock is ${span(Math.abs(run.ahead))} ${run.ahead > 0 ? "behind" : "ahead of"} this one`;
      return { kind: beat.silent > quiet ? "slow" : "alive", text };
    }
    if (beat?.state === "ended") return { kind: "ended", text: `ended at ${this.since(run)}` };
    if (beat?.state === "stopped") return { kind: "gone", text: `stopped before its end at ${this.since(run)}` };
    if (run.gone) return { kind: "gone", text: `gone since ${this.since(run)}` };
    if (this.connected === null) return { kind: "gone", text: `unknown, the last sign was at ${this.since(run)}` };
    if (!run.heard && performance.now() - this.connected < first) return { kind: "waiting", text: "waiting for a sign of life" };
    return { kind: "gone", text: `no sign of life since ${this.since(run)}` };
  }

  /// Why what is shown is not current; null: it is.
  stale() {
    if (this.connected === null)
      return { kind: "gone", text: this.left ? `No connection to the broker since ${clock(this.left)}: what is shown is of that time.` : "No connection to the broker yet." };
    if (this.anyAlive()) return null;
    const known = [...this.runs.keys()];
    if (!known.length) return { kind: performance.now() - this.connected < first ? "waiting" : "gone", text: "No run has given a sign of life." };
    const found = known.map((name) => ({ name, ...this.describe(name) }));
    const worst = ["gone", "waiting", "ended"].find((kind) => found.some((f) => f.kind === kind));
    return { kind: worst, text: `What is shown is not current. ${found.map((f) => `${f.name}: ${f.text}`).join("; ")}.` };
  }
}
