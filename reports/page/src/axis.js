// Numbers and ticks of charts, for the figures of pages and for the panel's charts: one way to write a value, whoever draws.

export const superscript = (k) => String(k).replace(/./g, (c) => "⁰¹²³⁴⁵⁶⁷⁸⁹⁻"["0123456789-".indexOf(c)]);

export function number(x, digits = 4) {
  if (!Number.isFinite(x)) return "–";
  if (x === 0) return "0";
  const size = Math.abs(x);
  if (size >= 1e5 || size < 1e-4) {
    const [mantissa, exponent] = x.toExponential(Math.max(0, digits - 2)).split("e");
    return `${mantissa.replace("-", "−")} × 10${superscript(Number(exponent))}`;
  }
  return x.toFixed(Math.max(0, digits - 1 - Math.floor(Math.log10(size)))).replace("-", "−");
}

// A value that is known to a step: no digit that the step leaves open.
export function resolved(x, step) {
  if (!(Math.abs(x) >= step / 2)) return Number.isFinite(x) ? "0" : "–";
  return number(x, Math.min(9, Math.max(1, 1 + Math.floor(Math.log10(Math.abs(x))) - Math.floor(Math.log10(step)))));
}

// What a cursor finds of a curve: a value, or the range of those that stand under it.
export function reading(name, low, high, unit, write) {
  const [a, b] = [write(low), write(high)];
  return [name, a === b ? a : `${a} to ${b}`, unit].filter(Boolean).join(" ");
}

// Multiples of 1, 2 or 5 times a power of ten, about as many as wanted.
export function ticks(low, high, wanted, step = null) {
  const raw = (high - low) / Math.max(1, wanted);
  if (!(raw > 0) || !Number.isFinite(raw)) return [];
  const decade = 10 ** Math.floor(Math.log10(raw));
  step ??= [1, 2, 5, 10].map((s) => s * decade).find((s) => s >= raw);
  const out = [];
  for (let k = Math.ceil(low / step); k * step <= high; k++) out.push(k * step);
  return out;
}

// Ticks of a logarithmic axis: powers of ten, of many every second and so on; of less than two decades also 2 and 5 times them.
export function decades(low, high, wanted) {
  const [a, b] = [Math.log10(low), Math.log10(high)];
  if (b - a < 0.7) return ticks(low, high, wanted);
  const stride = Math.ceil((b - a) / Math.max(1, wanted));
  const parts = 3 * (b - a) <= wanted ? [1, 2, 5] : [1];
  const out = [];
  for (let k = stride * Math.floor(a / stride); k <= b; k += stride) out.push(...parts.map((part) => part * 10 ** k));
  return out.filter((x) => x >= low * (1 - 1e-9) && x <= high * (1 + 1e-9));
}

// A tick's label: as many digits as it has.
export const tick = (x) => (x === 0 ? "0" : Math.abs(x) >= 1e6 || Math.abs(x) < 1e-4 ? number(x, 3) : String(Number(x.toPrecision(10))).replace("-", "−"));
