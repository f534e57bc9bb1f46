// Nine amplitude densities over frequency, both axes logarithmic.
import { superscript } from "/axis.js";
import { fit, colourOf, dashedOf } from "/chart.js";

export function draw(canvas, spectrum) {
  const { w, h, pen, css } = fit(canvas);
  if (!spectrum || w < 50) return;
  const [left, bottom] = [44, h - 34];
  const all = spectrum.densities.flat().filter((d) => d > 0);
  if (!all.length) return;
  const x0 = Math.log10(spectrum.frequencies_hz[0]), x1 = Math.log10(spectrum.frequencies_hz.at(-1));
  const y0 = Math.floor(Math.log10(all.reduce((a, b) => Math.min(a, b)))), y1 = Math.ceil(Math.log10(all.reduce((a, b) => Math.max(a, b))));
  const x = (f) => left + (Math.log10(f) - x0) / (x1 - x0) * (w - left - 8);
  const y = (d) => bottom - (Math.log10(d) - y0) / Math.max(1, y1 - y0) * (bottom - 20);
  for (let k = y0; k <= y1; k++) {
    pen.path([left, y(10 ** k), w - 8, y(10 ** k)], css("--grid"), 1);
    pen.text(left - 5, y(10 ** k), `10${superscript(k)}`, css("--ink-2"), "right", 11);
  }
  for (let k = Math.ceil(x0); k <= x1; k++) {
    pen.path([x(10 ** k), 20, x(10 ** k), bottom], css("--grid"), 1);
    pen.text(x(10 ** k), bottom + 10, String(10 ** k), css("--ink-2"), "center", 11);
  }
  pen.path([left, 20, left, bottom, w - 8, bottom], css("--axis"), 1);
  pen.text(left, 8, "V/√Hz", css("--ink-2"), "left", 11);
  pen.text(w - 8, bottom + 24, "Hz", css("--ink-2"), "right", 11);
  spectrum.densities.forEach((densities, k) => {
    const points = [];
    densities.forEach((d, i) => { if (d > 0 && i < spectrum.frequencies_hz.length) points.push(x(spectrum.frequencies_hz[i]), y(d)); });
    pen.path(points, css(colourOf(k)), 1.3, dashedOf(k));
  });
}
