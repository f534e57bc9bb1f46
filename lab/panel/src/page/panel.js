// The panel: one WebSocket, four tabs, one strip chart. All that comes from data is text and never markup.
import { number } from "/axis.js";
import { Strip, read, volts, colourOf, dashedOf } from "/chart.js";
import * as day from "/day.js";
import * as cube from "/cube.js";
import * as spectrum from "/spectrum.js";

const $ = (id) => document.getElementById(id);
const state = { tab: "acquisition", hello: null, status: null, spectrum: null, picture: null, yours: false, span: 10, end: null, paused: false };

// ---- token: in the link once, then out of sight.
const link = new URL(location.href);
if (link.searchParams.has("token")) {
  try { sessionStorage.setItem("token", link.searchParams.get("token")); } catch {}
  state.token = link.searchParams.get("token");
  link.searchParams.delete("token");
  history.replaceState(null, "", link);
}
try { state.token ??= sessionStorage.getItem("token"); } catch {}

// ---- connection
let socket = null, view = "";
function send(message) {
  if (socket?.readyState === WebSocket.OPEN) socket.send(JSON.stringify(message));
}
export function command(what, more = {}) { send({ do: what, ...more }); }

function banner(text) {
  $("banner").hidden = !text;
  $("banner").textContent = text || "";
}

let refusals = 0;
function refused(cause) {
  const mine = ++refusals;
  banner(`Refused: ${cause}.`);
  setTimeout(() => { if (mine === refusals && socket?.readyState === WebSocket.OPEN) banner(""); }, 6000);
}

function connect() {
  if (!state.token) {
    banner("This page needs the link that sixaxis panel has printed: its token is missing.");
    return;
  }
  socket = new WebSocket(`ws://${location.host}/socket?token=${encodeURIComponent(state.token)}`);
  socket.binaryType = "arraybuffer";
  let opened = false;
  socket.onopen = () => { opened = true; banner(""); view = ""; ask(); };
  socket.onclose = () => {
    banner(opened ? "The connection is lost; trying again." : "No connection. If the panel was started anew, open its new link.");
    $("source").textContent = "not connected";
    setTimeout(connect, 1000);
  };
  socket.onmessage = (event) => {
    if (event.data instanceof ArrayBuffer) return picture(event.data);
    const message = JSON.parse(event.data);
    if (message.hello) hello(message.hello);
    if (message.status) status(message.status);
    if (message.spectrum) { state.spectrum = message.spectrum; if (state.tab === "acquisition") spectrum.draw($("spectrum"), state.spectrum); }
    if (message.day) { day.take(message.day, state, command); }
    if (message.controls) controls(message.controls);
    if (message.refused) refused(message.refused);
  };
}

// ---- what each tab draws
const limb = (first, k, prefix) => ({ column: first + k, colour: colourOf(k), dashed: dashedOf(k), name: `${prefix}${k + 1}` });
const nine = [...Array(9).keys()];
const AXES = ["ax", "ay", "az", "αx", "αy", "αz"];
const PANELS = {
  acquisition: () => [
    ...nine.map((k) => ({ title: `u${k + 1}`, unit: "V", curves: [limb(0, k, "u")] })),
    ...(state.status?.start.standards ? [
      { title: "accelerometer", unit: "m/s²", curves: [{ column: 9, colour: "--ink", name: "accelerometer" }] },
      { title: "gyroscope", unit: "rad/s", curves: [{ column: 10, colour: "--ink", name: "gyroscope" }] },
    ] : []),
  ],
  preprocessing: () => nine.map((k) => ({ title: `limb ${k + 1}`, unit: "V", curves: [
    { column: k, colour: "--axis", quiet: true, name: "before" }, { ...limb(11, k, "after "), dashed: false },
  ] })),
  identification: () => [
    { title: "nine limbs", unit: "V", curves: nine.map((k) => limb(0, k, "u")) },
    { title: "accelerometer", unit: "m/s²", curves: [{ column: 9, colour: "--ink", name: "accelerometer" }] },
    { title: "gyroscope", unit: "rad/s", curves: [{ column: 10, colour: "--ink", name: "gyroscope" }] },
  ],
  decoupling: () => [
    ...AXES.map((name, k) => ({ title: name, unit: k < 3 ? "m/s²" : "rad/s²", curves: [
      { column: accelerations()[0] + k, colour: colourOf(k % 3), name: "decoupled" },
      ...(state.status?.start.truth ? [{ column: accelerations()[1] + k, colour: "--ink", dashed: true, name: "truth" }] : []),
    ] })),
    ...(state.status?.start.standards ? [["along the run", "m/s²"], ["rate about it", "rad/s"]].map(([title, unit], k) => ({ title, unit, curves: [
      { column: 50 + k, colour: "--s3", name: "decoupled" }, { column: 52 + k, colour: "--ink", dashed: true, name: "instrument" },
    ] })) : []),
    { title: "rate, shell", unit: "rad/s", curves: ["ωx", "ωy", "ωz"].map((name, k) => ({ column: 26 + k, colour: colourOf(k), name })) },
    { title: "parity", unit: "m/s²", curves: ["1+2+4+5", "1+3+7+9", "5+6+8+9"].map((name, k) => ({ column: 29 + k, colour: colourOf(k), name })) },
  ],
};
// First columns of the accelerations and of the truth, in the axes that are looked at.
const accelerations = () => (state.axes === "sensor" ? [38, 44] : [20, 32]);
const LEGENDS = {
  acquisition: [],
  preprocessing: [["before the stages", "--axis"], ["behind them, in the limb's colour", "--s0"]],
  identification: nine.map((k) => [`u${k + 1}`, colourOf(k), dashedOf(k)]),
  decoupling: [["x, or first relation", "--s0"], ["y, or second", "--s1"], ["z, or third", "--s2"], ["along the run", "--s3"], ["truth or instrument, behind the same low-pass", "--ink", true]],
};

const strip = new Strip($("strip"), $("cursor"));
function panels() {
  strip.show(PANELS[state.tab]());
  const legend = LEGENDS[state.tab].map(([name, colour, dashed]) => {
    const item = document.createElement("span");
    item.textContent = name; item.style.setProperty("--c", `var(${colour})`);
    if (dashed) item.className = "dashed";
    return item;
  });
  $("legend").replaceChildren(...legend);
  $("axes-label").hidden = state.tab !== "decoupling";
  $("scale-label").hidden = !["acquisition", "preprocessing"].includes(state.tab);
  view = ""; ask();
}
function ask() {
  const columns = [...new Set(strip.panels.flatMap((panel) => panel.curves.map((curve) => curve.column)))];
  const message = { do: "view", columns, span_s: state.span, end_s: state.end, points: strip.points() };
  const text = JSON.stringify(message);
  if (text !== view && columns.length) { view = text; send(message); }
}

let waiting = null;
function picture(buffer) {
  waiting = read(buffer);
  requestAnimationFrame(() => {
    if (!waiting) return;
    const p = waiting;
    waiting = null;
    if (state.source !== undefined && state.source !== p.source) { state.end = null; ask(); }
    state.source = p.source; state.picture = p;
    const to = state.end ?? p.now;
    p.view = { from: to - state.span, to };
    strip.take(p);
    $("f-fps").textContent = `${p.perSecond.toFixed(0)} /s`;
    $("f-dropped").textContent = String(p.dropped);
    $("f-latency").textContent = state.end === null ? `${p.latency.toFixed(0)} ms` : "–";
    if (state.tab === "decoupling") decoupling(p);
    // Said only when it is on the screen: the server's measure of latency, and its leave to send another.
    send({ do: "seen", picture: p.number });
  });
}

// ---- texts
function hello(hello) {
  state.hello = hello;
  $("lab").hidden = !hello.laboratory;
  $("wedge").replaceChildren(...hello.wedges.map((w, k) => option(k, `(${w.join(", ")})`)));
  $("wedge").value = "3";
  $("limb").replaceChildren(...nine.map((k) => option(k + 1, String(k + 1))));
}
function option(value, text) {
  const item = document.createElement("option");
  item.value = value; item.textContent = text;
  return item;
}
function cells(texts, heading = true) {
  const row = document.createElement("tr");
  texts.forEach((text, k) => {
    const cell = document.createElement(heading && k === 0 ? "th" : "td");
    if (text instanceof Node) cell.append(text); else cell.textContent = text;
    if (k > 0) cell.className = "number";
    row.append(cell);
  });
  return row;
}
function fill(table, rows) {
  // A table that is rewritten five times a second keeps its rows.
  const body = table.tBodies[0];
  if (body.rows.length !== rows.length) { body.replaceChildren(...rows.map((row) => cells(row))); return; }
  rows.forEach((row, r) => row.forEach((text, c) => {
    const cell = body.rows[r].cells[c];
    if (!(text instanceof Node) && cell.textContent !== text) cell.textContent = text;
  }));
}
function swatch(k) {
  const span = document.createElement("span"), line = document.createElement("span");
  line.className = `swatch${dashedOf(k) ? " dashed" : ""}`;
  line.style.setProperty("--c", `var(${colourOf(k)})`);
  span.append(line, String(k + 1));
  return span;
}

function status(s) {
  const before = state.status;
  state.status = s;
  if (!before || before.start.standards !== s.start.standards || before.start.truth !== s.start.truth) panels();
  strip.fullScale = s.full_scale_v;
  $("source").textContent = `${s.start.title}, ${s.start.sample_rate_hz.toLocaleString("en")} samples/s`;
  $("run").hidden = !s.run;
  $("run").textContent = s.run ? `running: ${s.run}` : "";
  $("f-rate").textContent = `${Math.round(s.received_per_s).toLocaleString("en")} /s`;
  $("f-rest").textContent = s.at_rest ? "at rest" : "moving";
  recording(s.recording);
  if (state.tab === "acquisition") {
    const [mean, least, most, noise] = ["mean_v", "min_v", "max_v", "noise_v"].map((key) => volts(s.channels.map((c) => c[key])));
    fill($("channels"), s.channels.map((c, k) => [
      swatch(k), mean[k], least[k], most[k], noise[k],
      `${(100 * Math.max(Math.abs(c.min_v), Math.abs(c.max_v)) / s.full_scale_v).toFixed(1)} %`,
      c.not_finite ? `${c.clipped}, ${c.not_finite} not finite` : String(c.clipped),
    ]));
    s.channels.forEach((c, k) => { $("channels").tBodies[0].rows[k].cells[6].className = `number ${c.clipped || c.not_finite ? "bad" : ""}`; });
  }
  if (state.tab === "preprocessing") {
    const [before, behind] = [volts(s.channels.map((c) => c.deviation_v)), volts(s.conditioned_deviation_v)];
    fill($("beside"), s.channels.map((c, k) => [
      swatch(k), before[k], behind[k], `${(100 * s.conditioned_deviation_v[k] / c.deviation_v).toFixed(0)} %`,
    ]));
  }
  notes(s.notes);
  const delay = s.delay_s > 0 ? `The stages run forwards only and delay by ${number(1e3 * s.delay_s, 3)} ms.` : "No stage delays.";
  $("s-delay").textContent = `${delay} A calibration conditions its trials by itself, both ways.`;
  if (document.activeElement?.closest("#stages") === null && JSON.stringify(before?.stages) !== JSON.stringify(s.stages)) {
    $("s-outliers").checked = s.stages.outliers; $("s-hold").checked = s.stages.hold_at_rest;
    $("s-low").checked = s.stages.low_pass_hz !== null; $("s-high").checked = s.stages.high_pass_hz !== null;
    if (s.stages.low_pass_hz !== null) $("s-low-hz").value = s.stages.low_pass_hz;
    if (s.stages.high_pass_hz !== null) $("s-high-hz").value = s.stages.high_pass_hz;
  }
  if (before?.parameters !== s.parameters) $("whose").value = s.parameters;
  [...$("whose").options].forEach((o, k) => { o.disabled = !s.available[k]; });
  $("watch").checked = s.watch;
  $("watch").disabled = !state.yours || s.parameters === "design";
  fill($("parity"), ["f1 + f2 + f4 + f5", "f1 + f3 + f7 + f9", "f5 + f6 + f8 + f9"].map((name, k) => [name, number(s.parity_rms[k], 3)]));
  const [excluded, suspected] = s.watched.map((digits) => String(digits).split("").filter((d) => d !== "0").join(", "));
  $("watched").className = suspected ? "bad" : excluded ? "warn" : "quiet";
  $("watched").textContent = !s.watch ? "The monitor is off." : suspected ? `Limb ${suspected} may have failed and cannot be excluded.`
    : excluded ? `Limb ${excluded} has failed and is excluded.` : "The monitor has found no failed limb.";
  day.running(s, state, command);
}

function notes(all) {
  const last = all.at(-1)?.[0];
  if (state.noted === last) return;
  state.noted = last;
  $("notes").replaceChildren(...all.slice().reverse().map(([, text]) => {
    const item = document.createElement("li");
    item.textContent = text;
    return item;
  }));
}

function recording(r) {
  const on = r && !r.finished && !r.failed;
  state.recording = on;
  $("record").textContent = on ? "Stop" : "Record";
  $("record").classList.toggle("on", Boolean(on));
  $("f-recording").textContent = on ? `${r.on_disk.toLocaleString("en")} rows` : "off";
  $("rec-state").className = r?.failed ? "bad" : "quiet";
  if (r) $("rec-state").textContent = r.failed ? `${r.name}: ${r.failed}` : r.finished ? `${r.finished}: ${r.on_disk.toLocaleString("en")} rows` : `${r.name}: ${r.on_disk.toLocaleString("en")} rows are on disk and survive a crash.`;
}

function controls({ yours, held }) {
  state.yours = yours;
  $("holder").textContent = yours ? "You hold the controls." : held ? "Another browser holds the controls." : "Nobody holds the controls.";
  $("take").hidden = yours;
  for (const id of ["go", "stop", "speed", "spoil", "record", "clear", "s-apply", "whose", "restart"]) $(id).disabled = !yours;
  day.allow(yours);
}

function decoupling(p) {
  const newest = (column) => { const v = p.values.get(column); return v ? 0.5 * (v.at(-2) + v.at(-1)) : NaN; };
  const last = (column) => { const v = p.values.get(column); for (let k = (v?.length ?? 0) - 2; k >= 0; k -= 2) if (!Number.isNaN(v[k])) return 0.5 * (v[k] + v[k + 1]); return newest(column); };
  const fixed = (x, decimals) => (Math.abs(x) < 0.5 / 10 ** decimals ? 0 : x).toFixed(decimals).replace("-", "−");
  // An axis that the run does not move has an error and no peak.
  const error = (six, k) => (!six ? "–" : six[k].share === null ? `${number(six[k].departure, 2)} ${k < 3 ? "m/s²" : "rad/s²"}` : `${number(100 * six[k].share, 2)} %`);
  const errors = state.status?.errors;
  fill($("now"), AXES.map((name, k) => [
    `${name}, ${k < 3 ? "m/s²" : "rad/s²"}`, fixed(last(accelerations()[0] + k), k < 3 ? 3 : 2), p.truth ? fixed(last(accelerations()[1] + k), k < 3 ? 3 : 2) : "–",
    error(errors?.[0], k), error(errors?.[1], k),
  ]));
  const standards = state.status?.errors_of_standards;
  $("beside-standards").hidden = !state.status?.start.standards;
  const beside = (x) => (Number.isNaN(x) ? "–" : fixed(x, 3));
  fill($("standards"), [["acceleration, m/s²", "m/s²"], ["rate, rad/s", "rad/s"]].map(([name, unit], k) => [
    name, beside(last(50 + k)), beside(last(52 + k)),
    !standards ? "–" : standards[k].share === null ? `${number(standards[k].departure, 2)} ${unit}` : `${number(100 * standards[k].share, 2)} %`,
  ]));
  if (!state.hello) return;
  const times = Number($("exaggerate").value);
  cube.draw($("cube"), p, times, state.hello);
  const turn = (q) => 2 * Math.acos(Math.min(1, Math.abs(q[0]))) * 180 / Math.PI;
  const apart = p.truth ? `; ${cube.angle(p.attitude, p.trueAttitude).toFixed(2)}° from the truth` : "";
  $("cube-note").textContent = `Shell turned by ${turn(p.attitude).toFixed(1)}°${apart}. The mass has moved by ${number(1e9 * Math.hypot(...p.position), 3)} nm in the shell, drawn ${times.toLocaleString("en")} times as large.`;
}

// ---- controls of the page
function tab(name) {
  state.tab = name;
  for (const button of document.querySelectorAll('[role="tab"]')) {
    const mine = button.dataset.tab === name;
    button.setAttribute("aria-selected", String(mine)); button.tabIndex = mine ? 0 : -1;
    $(button.dataset.tab).hidden = !mine;
  }
  panels();
  if (name === "acquisition") spectrum.draw($("spectrum"), state.spectrum);
  if (state.status) status(state.status);
}
function zoom(factor, at = 1) {
  const kept = state.status?.kept_s ?? 600;
  const span = Math.min(kept, Math.max(0.01, state.span * factor));
  if (state.end !== null) state.end += (at - 1) * (state.span - span);
  state.span = span;
  ask();
}
function move(share) {
  const now = state.picture?.now ?? 0;
  const end = (state.end ?? now) + share * state.span;
  state.end = end >= now && !state.paused ? null : Math.max(0, Math.min(now, end));
  pauseShown(); ask();
}
function pause(on) {
  state.paused = on;
  state.end = on ? state.picture?.now ?? 0 : null;
  pauseShown(); ask();
}
function pauseShown() {
  $("pause").textContent = state.end === null ? "Pause" : "Go on";
  $("pause").setAttribute("aria-pressed", String(state.end !== null));
}
function save(name, blob) {
  const a = document.createElement("a");
  a.href = URL.createObjectURL(blob); a.download = name;
  a.click();
  setTimeout(() => URL.revokeObjectURL(a.href), 10000);
}

for (const button of document.querySelectorAll('[role="tab"]')) button.onclick = () => tab(button.dataset.tab);
$("pause").onclick = () => pause(state.end === null);
$("zoom-in").onclick = () => zoom(0.5);
$("zoom-out").onclick = () => zoom(2);
$("back").onclick = () => move(-0.5);
$("forward").onclick = () => move(0.5);
$("live").onclick = () => pause(false);
$("scale").onchange = () => { strip.scale = $("scale").value; strip.ranges = []; strip.draw(); };
$("save-png").onclick = async () => save(`${state.tab}.png`, await strip.png());
$("save-svg").onclick = () => strip.picture && save(`${state.tab}.svg`, new Blob([strip.svg()], { type: "image/svg+xml" }));
$("save-csv").onclick = () => strip.picture && save(`${state.tab}.csv`, new Blob([strip.csv()], { type: "text/csv" }));
$("save-parquet").onclick = async () => {
  const asked = view && JSON.parse(view);
  if (!asked) return;
  const end = state.end ?? state.picture?.now ?? 0;
  const query = new URLSearchParams({ token: state.token, columns: asked.columns.join(), span_s: asked.span_s, end_s: end, points: asked.points });
  // Numbers stand in it, and commas between them.
  const answer = await fetch(`/seen.parquet?${decodeURIComponent(query)}`);
  if (answer.ok) save(`${state.tab}.parquet`, await answer.blob()); else refused(await answer.text());
};
$("axes").onchange = () => { state.axes = $("axes").value; panels(); };
$("take").onclick = () => command("take");
$("go").onclick = () => command("run", { run: {
  motion: $("motion").value, wedge: Number($("wedge").value), frequency_hz: Number($("frequency").value),
  amplitude: Number($("amplitude").value) / 100, seconds: Number($("seconds").value),
} });
$("stop").onclick = () => command("stop");
$("speed").onchange = () => command("speed", { speed: Number($("speed").value) });
$("spoil").onclick = () => {
  const kind = $("defect").value;
  const defect = kind === "" ? null : kind === "slip" ? { kind } : { kind, limb: Number($("limb").value) };
  command("defect", { defect });
};
$("record").onclick = () => state.recording ? command("stop_recording")
  : $("rec-name").reportValidity() && command("record", { name: $("rec-name").value, format: $("rec-format").value });
$("clear").onclick = () => command("clear_counts");
$("s-apply").onclick = () => command("stages", { stages: {
  low_pass_hz: $("s-low").checked ? Number($("s-low-hz").value) : null, outliers: $("s-outliers").checked,
  high_pass_hz: $("s-high").checked ? Number($("s-high-hz").value) : null, hold_at_rest: $("s-hold").checked,
} });
$("whose").onchange = () => command("parameters", { parameters: $("whose").value });
$("watch").onchange = () => command("watch", { on: $("watch").checked });
$("restart").onclick = () => command("restart");

$("strip").addEventListener("wheel", (e) => {
  if (!e.ctrlKey && Math.abs(e.deltaY) < Math.abs(e.deltaX)) return;
  e.preventDefault();
  zoom(e.deltaY > 0 ? 1.25 : 0.8, Math.max(0, Math.min(1, (e.offsetX - strip.left) / (strip.width - strip.left - strip.right))));
}, { passive: false });
let dragged = null;
$("strip").addEventListener("pointerdown", (e) => { dragged = { x: e.clientX, end: state.end ?? state.picture?.now ?? 0 }; $("strip").setPointerCapture(e.pointerId); });
$("strip").addEventListener("pointermove", (e) => {
  if (!dragged || Math.abs(e.clientX - dragged.x) < 4) return;
  const now = state.picture?.now ?? 0;
  const end = dragged.end - (e.clientX - dragged.x) / (strip.width - strip.left - strip.right) * state.span;
  state.end = end >= now ? null : Math.max(0, end);
  pauseShown(); ask();
});
$("strip").addEventListener("pointerup", () => { dragged = null; });
addEventListener("keydown", (e) => {
  if (["INPUT", "SELECT", "TEXTAREA"].includes(e.target.tagName) || e.ctrlKey || e.metaKey || e.altKey) return;
  const tabs = ["acquisition", "preprocessing", "identification", "decoupling"];
  const inTabs = e.target.getAttribute?.("role") === "tab";
  if (inTabs && (e.key === "ArrowRight" || e.key === "ArrowLeft")) {
    const next = tabs[(tabs.indexOf(state.tab) + (e.key === "ArrowRight" ? 1 : 3)) % 4];
    tab(next); $(`t-${next}`).focus(); e.preventDefault();
    return;
  }
  const keys = { " ": () => pause(state.end === null), "+": () => zoom(0.5), "=": () => zoom(0.5), "-": () => zoom(2), ArrowLeft: () => move(-0.25), ArrowRight: () => move(0.25), Home: () => pause(false) };
  if (e.key === " " && e.target.tagName === "BUTTON") return;
  if ("1234".includes(e.key) && e.key.length === 1) tab(tabs[Number(e.key) - 1]);
  else if (keys[e.key]) { keys[e.key](); e.preventDefault(); }
});
addEventListener("resize", () => { strip.draw(); ask(); });

// ---- theme, as on the report's pages
const root = document.documentElement, themes = ["auto", "light", "dark"];
const themeShown = () => { $("theme").textContent = `Theme: ${root.dataset.theme || "auto"}`; };
try { const kept = localStorage.getItem("theme"); if (kept) root.dataset.theme = kept; } catch {}
$("theme").onclick = () => {
  const next = themes[(themes.indexOf(root.dataset.theme || "auto") + 1) % 3];
  if (next === "auto") delete root.dataset.theme; else root.dataset.theme = next;
  try { if (next === "auto") localStorage.removeItem("theme"); else localStorage.setItem("theme", next); } catch {}
  themeShown(); strip.draw();
};
themeShown();
day.start(state, command);
tab(location.hash.slice(1) in PANELS ? location.hash.slice(1) : "acquisition");
connect();
