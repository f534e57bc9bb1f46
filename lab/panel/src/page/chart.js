// Strip charts over one time axis: smallest and largest sample of each bin as one stroke. The same drawing goes to a canvas, and to
// an SVG to be saved; what it draws goes to a CSV.

import { number, reading, tick, ticks } from "/axis.js";

const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
const FONT = 'system-ui, "Segoe UI", Roboto, "Liberation Sans", Arial, sans-serif';

// Nine limbs on eight colours: the ninth is the first, broken.
export const colourOf = (k) => `--s${k % 8}`;
export const dashedOf = (k) => k >= 8;

// Voltages that stand below each other: one prefix, one number of decimals.
export function volts(all) {
  const size = Math.max(...all.filter(Number.isFinite).map(Math.abs), 1e-6);
  const [times, unit] = size < 1e-3 ? [1e6, "µV"] : size < 1 ? [1e3, "mV"] : [1, "V"];
  const decimals = Math.max(0, 2 - Math.floor(Math.log10(size * times)));
  return all.map((x) => (Number.isFinite(x) ? `${(x * times).toFixed(decimals).replace("-", "−")} ${unit}` : "–"));
}

// The coarsest ticks of which at least two are well inside, so that an axis has a scale and not only a zero; of many every second.
function levels(low, high, edge) {
  const inside = (step) => ticks(low + edge, high - edge, 0, step);
  const decade = 10 ** Math.floor(Math.log10(high - low));
  const step = [5, 2, 1, 0.5, 0.2, 0.1].map((s) => s * decade).find((s) => inside(s).length >= 2);
  if (!step) return [];
  const all = inside(step);
  if (all.length > 3) return inside(2 * step);
  // Labels are 11 pixels high, the edge 5.
  return step < 11 / 5 * edge ? [all[0], all.at(-1)] : all;
}

class CanvasPen {
  constructor(ctx) { this.ctx = ctx; }
  path(points, colour, width, dash) {
    const { ctx } = this;
    ctx.strokeStyle = colour; ctx.lineWidth = width; ctx.setLineDash(dash ? [5, 4] : []);
    ctx.beginPath();
    let down = false;
    for (let k = 0; k < points.length; k += 2) {
      if (Number.isNaN(points[k + 1])) { down = false; continue; }
      if (down) ctx.lineTo(points[k], points[k + 1]); else ctx.moveTo(points[k], points[k + 1]);
      down = true;
    }
    ctx.stroke();
  }
  text(x, y, text, colour, align = "left", size = 12) {
    const { ctx } = this;
    ctx.font = `${size}px ${FONT}`; ctx.textAlign = align; ctx.textBaseline = "middle";
    // A halo, so that a label is read over a curve.
    ctx.strokeStyle = css("--paper"); ctx.lineWidth = 4; ctx.lineJoin = "round"; ctx.setLineDash([]);
    ctx.strokeText(text, x, y);
    ctx.fillStyle = colour; ctx.fillText(text, x, y);
  }
  clip(x, y, w, h) { const { ctx } = this; ctx.save(); ctx.beginPath(); ctx.rect(x, y, w, h); ctx.clip(); }
  unclip() { this.ctx.restore(); }
}

class SvgPen {
  constructor() { this.out = []; this.clips = 0; }
  escape(text) { return text.replace(/[&<>"]/g, (c) => ({ "&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;" })[c]); }
  path(points, colour, width, dash) {
    let d = "", down = false;
    for (let k = 0; k < points.length; k += 2) {
      if (Number.isNaN(points[k + 1])) { down = false; continue; }
      d += `${down ? "L" : "M"}${points[k].toFixed(1)} ${points[k + 1].toFixed(1)}`;
      down = true;
    }
    if (d) this.out.push(`<path d="${d}" fill="none" stroke="${colour}" stroke-width="${width}"${dash ? ' stroke-dasharray="5 4"' : ""}/>`);
  }
  text(x, y, text, colour, align = "left", size = 12) {
    const anchor = { left: "start", center: "middle", right: "end" }[align];
    this.out.push(`<text x="${x}" y="${y}" dy="0.35em" fill="${colour}" font-size="${size}" text-anchor="${anchor}" paint-order="stroke" stroke="${css("--paper")}" stroke-width="4" stroke-linejoin="round">${this.escape(text)}</text>`);
  }
  clip(x, y, w, h) {
    this.clips += 1;
    this.out.push(`<clipPath id="c${this.clips}"><rect x="${x}" y="${y}" width="${w}" height="${h}"/></clipPath><g clip-path="url(#c${this.clips})">`);
  }
  unclip() { this.out.push("</g>"); }
}

export class Strip {
  // panels: [{ title, unit, curves: [{ column, colour, dashed, name, quiet }] }]
  constructor(canvas, readout) {
    this.canvas = canvas; this.readout = readout;
    this.panels = []; this.picture = null; this.ranges = []; this.pointer = null;
    this.scale = "own"; this.fullScale = 10;
    this.left = 140; this.right = 8; this.foot = 26; this.head = 0;
    canvas.addEventListener("pointermove", (e) => { this.pointer = [e.offsetX, e.offsetY]; this.draw(); });
    const hint = readout.textContent;
    canvas.addEventListener("pointerleave", () => { this.pointer = null; readout.textContent = hint; this.draw(); });
  }
  show(panels) { this.panels = panels; this.ranges = []; this.picture = null; this.size(); this.draw(); }
  size() {
    const width = this.canvas.parentElement.clientWidth;
    const narrow = width < 600;
    // Titles stand at the left, or above where there is no room.
    this.head = narrow ? 15 : 0;
    const each = (this.panels.length > 6 ? 46 : 66) + this.head;
    const height = this.panels.length * each + this.foot;
    const scale = Math.min(2, window.devicePixelRatio || 1);
    if (this.canvas.width !== Math.round(width * scale) || this.canvas.height !== Math.round(height * scale)) {
      this.canvas.width = Math.round(width * scale); this.canvas.height = Math.round(height * scale);
      this.canvas.style.height = `${height}px`;
    }
    this.left = narrow ? 46 : 140;
    [this.width, this.height, this.each, this.ratio] = [width, height, each, scale];
  }
  points() { return Math.max(50, Math.min(2000, Math.round((this.width || 800) - this.left - this.right))); }
  take(picture) { this.picture = picture; this.draw(); }
  extent(panel) {
    let low = Infinity, high = -Infinity;
    for (const curve of panel.curves) {
      const values = this.picture.values.get(curve.column);
      if (!values) continue;
      for (let k = 0; k < values.length; k += 2) {
        if (values[k] < low) low = values[k];
        if (values[k + 1] > high) high = values[k + 1];
      }
    }
    return [low, high];
  }
  // Ranges grow at once and shrink slowly, so that the scale does not flicker.
  range(k, panels) {
    if (this.scale === "full" && this.panels[k].unit === "V") return [-this.fullScale, this.fullScale];
    let [low, high] = this.extent(panels[k]);
    if (this.scale === "common") {
      for (const panel of panels) {
        if (panel.unit !== panels[k].unit) continue;
        const [a, b] = this.extent(panel); low = Math.min(low, a); high = Math.max(high, b);
      }
    }
    if (!(low <= high)) return this.ranges[k] || [-1, 1];
    const pad = Math.max(0.08 * (high - low), 1e-6 * Math.max(Math.abs(low), Math.abs(high)), 1e-9);
    low -= pad; high += pad;
    const old = this.ranges[k];
    if (old) {
      low = low < old[0] ? low : old[0] + 0.08 * (low - old[0]);
      high = high > old[1] ? high : old[1] + 0.08 * (high - old[1]);
    }
    return (this.ranges[k] = [low, high]);
  }
  paint(pen, ranges) {
    const { picture: p, width, left, right, each } = this;
    const ink = css("--ink"), quiet = css("--ink-2"), grid = css("--grid"), axis = css("--axis");
    const wide = width - left - right;
    const [t0, t1] = [p.view.from, p.view.to];
    const x = (t) => left + (t - t0) / (t1 - t0) * wide;
    const times = ticks(t0, t1, wide / 110);
    this.panels.forEach((panel, k) => {
      const top = k * each + this.head + 3, bottom = (k + 1) * each - 3;
      const [low, high] = ranges[k];
      const y = (v) => bottom - (v - low) / (high - low) * (bottom - top);
      for (const t of times) pen.path([x(t), top, x(t), bottom], grid, 1);
      for (const v of levels(low, high, 5 / (bottom - top) * (high - low))) {
        pen.path([left, y(v), width - right, y(v)], grid, 1);
        pen.text(left - 6, y(v), tick(v), quiet, "right", 11);
      }
      pen.path([left, top, left, bottom, width - right, bottom], axis, 1);
      pen.clip(left, top - 1, wide, bottom - top + 2);
      for (const curve of panel.curves) {
        const values = p.values.get(curve.column);
        if (!values) continue;
        const points = new Float64Array(values.length * 2);
        for (let b = 0; b < values.length; b += 2) {
          const at = x(p.first + (b / 2 + 0.5) * p.step);
          points[2 * b] = at; points[2 * b + 1] = y(values[b]);
          points[2 * b + 2] = at; points[2 * b + 3] = y(values[b + 1]);
        }
        pen.path(points, css(curve.colour), curve.quiet ? 1 : 1.4, curve.dashed);
      }
      pen.unclip();
      if (this.head) pen.text(left, top - 9, `${panel.title}, ${panel.unit}`, ink, "left", 12);
      else {
        pen.text(2, (top + bottom) / 2 - 8, panel.title, ink, "left", 13);
        pen.text(2, (top + bottom) / 2 + 9, panel.unit, quiet, "left", 12);
      }
    });
    const foot = this.panels.length * each + 10;
    for (const t of times) pen.text(Math.min(Math.max(x(t), left + 8), width - 24), foot, `${tick(t)} s`, quiet, "center", 11);
  }
  draw() {
    const ctx = this.canvas.getContext("2d");
    this.size();
    ctx.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
    ctx.clearRect(0, 0, this.width, this.height);
    const pen = new CanvasPen(ctx);
    if (!this.picture) {
      pen.text(this.left, 20, "waiting for samples", css("--ink-2"));
      return;
    }
    const ranges = this.panels.map((_, k) => this.range(k, this.panels));
    this.paint(pen, ranges);
    this.cursor(pen);
  }
  cursor(pen) {
    if (!this.pointer) return;
    const [px, py] = this.pointer, p = this.picture;
    const wide = this.width - this.left - this.right;
    const t = p.view.from + (px - this.left) / wide * (p.view.to - p.view.from);
    const bin = Math.floor((t - p.first) / p.step);
    const panel = this.panels[Math.floor(py / this.each)];
    if (!panel || bin < 0 || bin >= p.bins || px < this.left) return;
    pen.path([px, 0, px, this.panels.length * this.each], css("--mark"), 1, true);
    const said = panel.curves.map((curve) => {
      const values = p.values.get(curve.column);
      if (!values) return "";
      return reading(curve.name, values[2 * bin], values[2 * bin + 1], panel.unit, (x) => number(x, 5));
    });
    this.readout.textContent = `${number(t, 6)} s: ${said.join(";  ")}`;
  }
  svg() {
    const pen = new SvgPen();
    this.paint(pen, this.panels.map((_, k) => this.range(k, this.panels)));
    return `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 ${this.width} ${this.height}" font-family='${FONT}'><rect width="100%" height="100%" fill="${css("--paper")}"/>${pen.out.join("")}</svg>`;
  }
  csv() {
    const p = this.picture;
    const curves = this.panels.flatMap((panel) => panel.curves.map((curve) => ({ ...curve, unit: panel.unit })));
    const shown = curves.filter((curve) => p.values.has(curve.column));
    const head = ["time [s]", ...shown.flatMap((c) => [`smallest ${c.name} [${c.unit}]`, `largest ${c.name} [${c.unit}]`])];
    const rows = [head.map((cell) => `"${cell.replace(/"/g, '""')}"`).join(",")];
    for (let b = 0; b < p.bins; b++) {
      const cells = shown.flatMap((c) => { const v = p.values.get(c.column); return [v[2 * b], v[2 * b + 1]]; });
      rows.push([p.first + b * p.step, ...cells].map((x) => (Number.isNaN(x) ? "nan" : x)).join(","));
    }
    return rows.join("\n") + "\n";
  }
  png() {
    return new Promise((done) => {
      const sheet = document.createElement("canvas");
      [sheet.width, sheet.height] = [this.canvas.width, this.canvas.height];
      const ctx = sheet.getContext("2d");
      ctx.fillStyle = css("--paper"); ctx.fillRect(0, 0, sheet.width, sheet.height);
      ctx.drawImage(this.canvas, 0, 0);
      sheet.toBlob(done, "image/png");
    });
  }
}

// A picture as the server sends it.
export function read(buffer) {
  const data = new DataView(buffer);
  const columns = data.getUint32(4, true), bins = data.getUint32(8, true);
  const pose = new Float32Array(buffer, 56, 14);
  const values = new Map();
  for (let k = 0; k < columns; k++) {
    values.set(data.getUint32(112 + 4 * k, true), new Float32Array(buffer, 112 + 4 * columns + 8 * bins * k, 2 * bins));
  }
  return {
    number: data.getUint32(0, true), bins, dropped: data.getUint32(12, true),
    first: data.getFloat64(16, true), step: data.getFloat64(24, true), now: data.getFloat64(32, true),
    latency: data.getFloat32(40, true), perSecond: data.getFloat32(44, true),
    source: data.getUint32(48, true), truth: data.getUint32(52, true) === 1,
    attitude: pose.slice(0, 4), trueAttitude: pose.slice(4, 8), position: pose.slice(8, 11), rotation: pose.slice(11, 14),
    values,
  };
}

export function fit(canvas) {
  const ratio = Math.min(2, window.devicePixelRatio || 1);
  const [w, h] = [canvas.clientWidth, canvas.clientHeight];
  if (canvas.width !== Math.round(w * ratio) || canvas.height !== Math.round(h * ratio)) {
    canvas.width = Math.round(w * ratio); canvas.height = Math.round(h * ratio);
  }
  const ctx = canvas.getContext("2d");
  ctx.setTransform(ratio, 0, 0, ratio, 0, 0);
  ctx.clearRect(0, 0, w, h);
  return { ctx, w, h, pen: new CanvasPen(ctx), css };
}
