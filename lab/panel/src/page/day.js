// Identification: the guided list, the check of each trial, the 25 parameters and the verdict.
import { number } from "/axis.js";

const $ = (id) => document.getElementById(id);
let outcome = null, inTurn = false, allowed = false, busy = false, lastDone = null, asked = null;
const MOTIONS = { static: "at rest", linear: "linear, slow", angular: "angular, slow", high_frequency_linear: "linear, fast", validation: "compound, for validation", tap: "tap" };

// The wedge's direction as it is engraved: small whole numbers.
function wedge(direction) {
  if (!direction) return "–";
  const least = Math.min(...direction.filter((x) => Math.abs(x) > 1e-6).map(Math.abs));
  return `(${direction.map((x) => String(Math.round(1e2 * x / least) / 1e2)).join(", ")})`;
}
const text = (tag, content, kind = "") => { const e = document.createElement(tag); e.textContent = content; e.className = kind; return e; };
const percent = (x) => `${number(100 * x, 2)} %`;
const hertz = (f) => (f === null ? "–" : `${f.toFixed(2)} Hz`);

function record(state, command, trial) { asked = trial; command("capture", { trial, done: false }); }

export function start(state, command) {
  $("next-go").onclick = () => { inTurn = false; if (outcome?.next !== null) record(state, command, outcome.next); };
  $("next-end").onclick = () => { inTurn = false; command("capture", { trial: 0, done: true }); };
  $("next-all").onclick = () => { inTurn = !inTurn; asked = null; step(state, command); buttons(state); };
}
// The next trial, once the rig stands and the one before is in the list, whichever is told last.
function step(state, command) {
  if (outcome?.next === null) inTurn = false;
  if (inTurn && allowed && !busy && outcome && outcome.next !== asked) record(state, command, outcome.next);
}
export function allow(yours) { allowed = yours; if (!yours) inTurn = false; buttons(null); }
function buttons(state) {
  const laboratory = state?.hello?.laboratory ?? true;
  const all = outcome?.next === null || !outcome?.trials.length;
  $("next-go").disabled = !allowed || busy || all || inTurn;
  $("next-end").disabled = !allowed || !busy;
  $("next-all").disabled = !allowed || (all && !inTurn);
  $("next-all").hidden = !laboratory;
  $("next-all").textContent = inTurn ? "Stop after this trial" : "Record all that is left";
  for (const button of document.querySelectorAll("#trials button")) button.disabled = !allowed || busy;
}
export function running(status, state, command) {
  const was = busy;
  busy = status.run !== null;
  if (was !== busy) { next(state, status); step(state, command); buttons(state); }
}

function next(state, status) {
  if (!outcome) return;
  const trial = outcome.trials[outcome.next];
  const running = status ?? state.status;
  if (running?.trial !== null && running?.trial !== undefined && busy) {
    $("next-text").textContent = `Recording ${outcome.trials[running.trial]?.name ?? "a trial"} …`;
  } else if (!outcome.trials.length) {
    $("next-text").textContent = "No calibration day: start the panel with --session, whose recordings are then made anew.";
  } else if (!trial) {
    $("next-text").textContent = "All recordings are there.";
  } else {
    const seconds = trial.seconds === null ? "" : `, ${trial.seconds.toFixed(1)} s`;
    $("next-text").textContent = trial.role === "static"
      ? `${trial.name}: leave the sensor at rest${seconds}.`
      : `${trial.name}: mount wedge ${wedge(trial.direction)}, run the rig at ${hertz(trial.frequency_hz)}, ${MOTIONS[trial.role]}${seconds}.${
        trial.worth ? ` It would narrow the interval of ${trial.worth.parameter} by ${percent(trial.worth.most)}, those of scale factors and inertias by ${percent(trial.worth.mean)} on average.` : ""}`;
  }
}

export function take(day, state, command) {
  const before = outcome;
  // A state that has been recorded and not yet calibrated keeps the parameters of the one before.
  outcome = day.calibrated || !before?.calibrated ? day
    : { ...before, trials: day.trials.map((t, k) => ({ ...t, error: before.trials[k]?.error ?? null, worth: t.check ? null : before.trials[k]?.worth ?? null })), next: day.next, problem: day.problem };
  const newest = outcome.trials.findIndex((t, k) => t.check && JSON.stringify(t.check) !== JSON.stringify(before?.trials[k]?.check));
  if (newest >= 0) lastDone = newest;
  next(state); trials(state, command); check(); verdict(); parameters(); buttons(state);
  step(state, command);
}

function check() {
  const trial = outcome.trials[lastDone];
  const rows = trial?.check?.lines ?? [];
  $("check").hidden = !rows.length;
  $("check").tBodies[0].replaceChildren(...rows.map((line, k) => {
    const row = document.createElement("tr");
    row.append(text("th", `${k ? "" : `${trial.name}: `}${line.what}`), text("td", line.found), text("td", line.asked), text("td", line.ok ? "✓" : "✕", line.ok ? "good" : "bad"));
    return row;
  }));
}

function trials(state, command) {
  $("trials").tBodies[0].replaceChildren(...outcome.trials.map((trial, k) => {
    const row = document.createElement("tr");
    if (k === outcome.next) row.setAttribute("aria-current", "true");
    const wrong = trial.check?.lines.filter((line) => !line.ok).map((line) => line.what) ?? [];
    const mark = !trial.check ? text("td", "–") : wrong.length ? text("td", `✕ ${wrong.join(", ")}`, "bad") : text("td", "✓", "good");
    const action = document.createElement("td");
    const again = text("button", trial.check ? "Repeat" : "Record");
    again.onclick = () => { inTurn = false; record(state, command, k); };
    action.append(again);
    if (trial.check) {
      const drop = text("button", "Discard");
      drop.onclick = () => command("discard", { trial: k });
      action.append(" ", drop);
    }
    row.append(text("th", trial.name), text("td", MOTIONS[trial.role]), text("td", wedge(trial.direction)), text("td", hertz(trial.frequency_hz), "number"), mark,
      text("td", trial.error === null ? "–" : `${(100 * trial.error).toFixed(2)} %`, "number"),
      text("td", trial.worth ? `${percent(trial.worth.most)} of ${trial.worth.parameter}` : "–"), action);
    return row;
  }));
}

function verdict() {
  const kind = { good: "good", reserved: "warn", bad: "bad" }[outcome.grade];
  if (kind) {
    $("verdict").className = kind;
    $("verdict").textContent = `${{ good: "✓", warn: "!", bad: "✕" }[kind]} ${outcome.sentence}`;
  }
  const items = outcome.findings.map((f) => text("li", `${f.cause}, ${f.place}: ${f.evidence}. What to do: ${f.advice}.`));
  items.push(...outcome.reservations.map((r) => text("li", r)));
  if (outcome.problem) items.push(text("li", outcome.problem, "bad"));
  $("findings").replaceChildren(...items);
  $("cal-file").textContent = outcome.file ? `By ${outcome.estimator}. Written to ${outcome.file}; decode recordings with it: sixaxis decouple.` : "";
}

// Half widths on a logarithmic axis, the first calibration at the left.
function spark(widths) {
  const NS = "http://www.w3.org/2000/svg";
  const svg = document.createElementNS(NS, "svg");
  svg.setAttribute("class", "spark"); svg.setAttribute("viewBox", "0 0 100 20"); svg.setAttribute("preserveAspectRatio", "none");
  const known = widths.map((w, k) => [k, w]).filter(([, w]) => w > 0);
  if (known.length > 1) {
    const logs = known.map(([, w]) => Math.log(w));
    const low = Math.min(...logs), high = Math.max(...logs, low + 0.7);
    const line = document.createElementNS(NS, "polyline");
    line.setAttribute("points", known.map(([k, w]) => `${2 + 96 * k / (widths.length - 1)},${18 - 16 * (Math.log(w) - low) / (high - low)}`).join(" "));
    line.setAttribute("fill", "none"); line.style.stroke = "var(--s0)"; line.setAttribute("stroke-width", "1.5"); line.setAttribute("vector-effect", "non-scaling-stroke");
    svg.append(line);
  }
  return svg;
}
// As people write them: mV and mm².
const SHOWN = { V: [1e3, "mV"], "m²": [1e6, "mm²"], "m^2": [1e6, "mm²"], "1/kg": [1, "kg⁻¹"], "1/s²": [1, "s⁻²"], "1/s^2": [1, "s⁻²"] };
// An estimate with as many decimals as two digits of its interval have.
const known = (x, half) => (half > 0 && half < 1e4 ? x.toFixed(Math.max(0, 1 - Math.floor(Math.log10(half)))).replace("-", "−") : number(x, 4));
const plain = (x) => (Math.abs(x) < 1e5 ? String(Number(x.toPrecision(5))).replace("-", "−") : number(x, 4));
function parameters() {
  $("parameters").tBodies[0].replaceChildren(...outcome.parameters.map((p) => {
    const row = document.createElement("tr");
    const curve = document.createElement("td");
    curve.append(spark(p.widths));
    const [times, unit] = SHOWN[p.unit] ?? [1, p.unit];
    row.append(text("th", p.name), text("td", p.determined && p.half_width_95 !== null ? known(times * p.estimate, times * p.half_width_95) : number(times * p.estimate, 4), "number"),
      text("td", p.determined && p.half_width_95 !== null ? number(times * p.half_width_95, 2) : "not determined", `number${p.determined ? "" : " warn"}`),
      text("td", unit), text("td", plain(times * p.design), "number"), curve, text("td", p.dominated_by));
    return row;
  }));
  $("parameters").hidden = !outcome.parameters.length;
}
