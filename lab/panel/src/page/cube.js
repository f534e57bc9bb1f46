// The mass on its nine limbs in the shell, turned by the attitude; the mass' own motion in the shell exaggerated.
import { fit } from "/chart.js";

const E = [[0, 0, 1], [0, -1, 0], [-1, 0, 0], [0, 0, -1], [0, 1, 0], [-1, 0, 0], [0, 0, -1], [0, -1, 0], [1, 0, 0]];
const NODE = [2, 2, 2, 1, 1, 1, 0, 0, 0];

const add = (a, b, s = 1) => a.map((x, k) => x + s * b[k]);
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const turned = ([w, x, y, z], v) => {
  const q = [x, y, z], t = cross(q, v).map((c) => 2 * c);
  return add(add(v, t, w), cross(q, t));
};
const rotated = (phi, v) => {
  const angle = Math.hypot(...phi);
  if (angle < 1e-12) return v;
  const half = 0.5 * angle, s = Math.sin(half) / angle;
  return turned([Math.cos(half), ...phi.map((p) => p * s)], v);
};
// Seen from above, front right: x to the lower left, y to the right, z up.
const seen = ([x, y, z]) => [-0.62 * x + 0.78 * y, -0.36 * x - 0.29 * y + 0.89 * z];
const depth = ([x, y, z]) => 0.69 * x + 0.55 * y + 0.46 * z;

function box(half) {
  const corners = [];
  for (const x of [-1, 1]) for (const y of [-1, 1]) for (const z of [-1, 1]) corners.push([x * half, y * half, z * half]);
  const edges = [];
  for (let a = 0; a < 8; a++) for (const bit of [1, 2, 4]) if (!(a & bit)) edges.push([a, a | bit]);
  return { corners, edges };
}

export function draw(canvas, pose, exaggeration, sizes) {
  const { w, h, pen, css, ctx } = fit(canvas);
  if (w < 50) return;
  const n = sizes.half_edge_m, length = sizes.limb_length_m;
  const shell = box(n + 1.06 * length);
  const unit = 0.27 * Math.min(w, h) / (n + length);
  const at = (v) => { const [x, y] = seen(v); return [0.5 * w + unit * x, 0.52 * h - unit * y]; };
  const line = (a, b, colour, width, dash) => pen.path([...at(a), ...at(b)], colour, width, dash);
  const q = pose.attitude;
  // Ground axes, fixed.
  const reach = 1.75 * (n + length);
  ["x", "y", "z"].forEach((name, k) => {
    const end = [0, 0, 0]; end[k] = reach;
    line([0, 0, 0], end, css("--grid"), 1.5);
    pen.text(...at(add(end, end, 0.06)), `${name} ground`, css("--ink-2"), "center", 11);
  });
  const corners = shell.corners.map((c) => turned(q, c));
  const back = corners.indexOf(corners.reduce((a, b) => (depth(b) < depth(a) ? b : a)));
  for (const [a, b] of shell.edges) line(corners[a], corners[b], css("--axis"), 1, a === back || b === back);
  // Mass: its own pose in the shell, exaggerated.
  const phi = [...pose.rotation].map((p) => p * exaggeration);
  const shift = [...pose.position].map((p) => p * exaggeration);
  const inShell = (v) => add(rotated(phi, v), shift);
  const mass = box(n);
  const placed = mass.corners.map((c) => turned(q, inShell(c)));
  ctx.globalAlpha = 0.16; ctx.fillStyle = css("--s0");
  for (const [bit, side] of [[1, 0], [1, 1], [2, 0], [2, 1], [4, 0], [4, 1]]) {
    const [u, v] = [1, 2, 4].filter((b) => b !== bit);
    const base = side ? bit : 0;
    ctx.beginPath();
    for (const k of [base, base | u, base | u | v, base | v]) ctx.lineTo(...at(placed[k]));
    ctx.fill();
  }
  ctx.globalAlpha = 1;
  for (const [a, b] of mass.edges) line(placed[a], placed[b], css("--s0"), 1.8);
  E.forEach((e, k) => {
    const t = [0, 0, 0]; t[NODE[k]] = -n;
    const hinge = add(t, e, -length);
    line(turned(q, hinge), turned(q, inShell(t)), css("--s1"), 2.2);
  });
  ["x", "y", "z"].forEach((name, k) => {
    const end = [0, 0, 0]; end[k] = 1.25 * (n + length);
    const tip = turned(q, end);
    line([0, 0, 0], tip, css(["--s7", "--s2", "--s5"][k]), 2);
    pen.text(...at(add(tip, tip, 0.1)), name, css("--ink"), "center", 13);
  });
}

export function angle(a, b) {
  const dot = Math.abs(a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3]);
  return 2 * Math.acos(Math.min(1, dot)) * 180 / Math.PI;
}
