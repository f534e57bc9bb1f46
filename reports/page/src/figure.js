// Figures under a pointer: a cursor that reads the curves, and zoom along the abscissa. What is read are the drawn strokes themselves,
// whose axes stand beside them in attributes (`reading.rs`). Without this script a figure is the picture that it is with it.

const NS = "http://www.w3.org/2000/svg";
// Screen pixels: within which a marker catches the cursor, and from which on a press is a drag.
const CATCH = 12, DRAG = 6;
// Shares of the abscissa: the least that is shown, and a step of the keyboard.
const LEAST = 1 / 64, STEP = 1 / 200;

const draw = (parent, name, attributes) => {
  const element = document.createElementNS(NS, name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  return parent.appendChild(element);
};
const make = (parent, name, attributes) => parent.appendChild(Object.assign(document.createElement(name), attributes));

const valueAt = ({ at, ends, log }, place) => {
  const share = (place - at[0]) / (at[1] - at[0]);
  return log ? ends[0] * (ends[1] / ends[0]) ** share : ends[0] + share * (ends[1] - ends[0]);
};
const placeOf = ({ at, ends, log }, value) => {
  const share = log ? Math.log(value / ends[0]) / Math.log(ends[1] / ends[0]) : (value - ends[0]) / (ends[1] - ends[0]);
  return at[0] + share * (at[1] - at[0]);
};
// How far a value changes over some drawing units.
const stepAt = (axis, place, units) => Math.abs(valueAt(axis, place + units) - valueAt(axis, place));

// A path's points, one after the other; the path has its first point and steps from there.
function pointsOf(path) {
  const steps = path.getAttribute("d").match(/-?\d+/g).map(Number);
  for (let k = 2; k < steps.length; k++) steps[k] += steps[k - 2];
  return steps;
}

class Chart {
  constructor(svg) {
    this.svg = svg;
    this.sheet = svg.parentElement;
    this.x = JSON.parse(svg.dataset.x);
    this.range = this.shown = this.x.at;
    this.width = svg.viewBox.baseVal.width;
    this.fields = [...svg.querySelectorAll("[data-y]")].map((group) => ({
      group, y: JSON.parse(group.dataset.y), data: group.querySelector(".data"), ticks: group.querySelector(".ticks"),
      curves: [...group.querySelectorAll("[data-name]")].map((curve) => ({
        name: curve.dataset.name, colour: curve.dataset.colour,
        strokes: [...curve.querySelectorAll(":scope > path")].map(pointsOf),
        markers: [...curve.querySelectorAll("use")].map((use) => [Number(use.getAttribute("x")), Number(use.getAttribute("y"))]),
      })),
    }));
    for (const field of this.fields) field.whole = field.ticks.cloneNode(true);
    this.paths = [...svg.querySelectorAll(".data path")].filter((path) => !path.closest("defs")).map((path) => [path, pointsOf(path), path.getAttribute("d").endsWith("z")]);
    this.uses = [...svg.querySelectorAll("use")].map((use) => [use, Number(use.getAttribute("x"))]);
    this.guides = [...svg.querySelectorAll("[data-at]")].map((guide) => [guide, Number(guide.dataset.at)]);
    this.readout = make(this.sheet, "div", { className: "readout", role: "status", hidden: true });
    this.button = make(this.sheet, "button", { className: "whole", type: "button", textContent: "Whole range", hidden: true });
    this.button.onclick = () => this.zoom(this.range);
    svg.setAttribute("role", "application");
    svg.setAttribute("aria-roledescription", "figure with a cursor");
  }

  // Drawing units in a screen pixel.
  get unit() { return this.width / this.svg.getBoundingClientRect().width; }
  get scale() { return (this.range[1] - this.range[0]) / (this.shown[1] - this.shown[0]); }
  out(x) { return this.range[0] + (x - this.shown[0]) * this.scale; }
  back(px) { return this.shown[0] + (px - this.range[0]) / this.scale; }
  inside(x) { return x >= this.shown[0] - 1e-6 && x <= this.shown[1] + 1e-6; }

  // Shows the part of the abscissa between two places of the whole drawing.
  zoom([from, to]) {
    const whole = this.range[1] - this.range[0];
    const wide = Math.min(whole, Math.max(LEAST * whole, to - from));
    from = Math.min(Math.max((from + to - wide) / 2, this.range[0]), this.range[1] - wide);
    this.shown = [from, from + wide];
    const zoomed = wide < whole;
    for (const [path, points, closed] of this.paths) {
      path.setAttribute("d", `M${points.map((p, k) => (k % 2 ? p : this.out(p).toFixed(1))).join(" ")}${closed ? "z" : ""}`);
    }
    for (const [use, x] of this.uses) {
      use.setAttribute("x", this.out(x));
      use.style.display = this.inside(x) ? "" : "none";
    }
    for (const [guide, x] of this.guides) {
      guide.setAttribute("transform", `translate(${this.out(x) - x})`);
      guide.style.display = this.inside(x) ? "" : "none";
    }
    for (const field of this.fields) {
      this.clip(field, zoomed);
      field.ticks.replaceChildren(...(zoomed ? this.ticks(field) : field.whole.cloneNode(true).childNodes));
    }
    this.button.hidden = !zoomed;
    this.hide();
  }

  clip(field, zoomed) {
    if (!zoomed) return field.data.removeAttribute("clip-path");
    if (!field.clip) {
      field.clip = `clip-${this.svg.querySelector("title").id}-${this.fields.indexOf(field)}`;
      const [left, right] = this.range, [bottom, top] = field.y.at, edge = 24;
      draw(draw(this.svg, "clipPath", { id: field.clip }), "rect", { x: left, y: top - edge, width: right - left, height: bottom - top + 2 * edge });
    }
    field.data.setAttribute("clip-path", `url(#${field.clip})`);
  }

  // Ticks of the part that is shown, drawn as those of the whole.
  ticks(field) {
    const [low, high] = this.shown.map((place) => valueAt(this.x, place));
    const grid = [...field.whole.children].find((child) => child.tagName === "path"), label = field.whole.querySelector("text");
    const size = Number((label ?? this.svg.querySelector(".ticks text"))?.getAttribute("font-size")) || 1;
    const ten = 10 ** this.x.power, room = (this.range[1] - this.range[0]) / size;
    let values = [], labels = [];
    // As many as leave a gap between their labels.
    for (let wanted = 12; wanted > 0; wanted--) {
      values = this.x.log ? decades(low, high, wanted) : ticks(low / ten, high / ten, wanted).map((x) => x * ten);
      const step = (values[1] - values[0]) / ten;
      const decimals = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
      labels = values.map((x) => (this.x.log ? tick(Number(x.toPrecision(10))) : (Math.abs(x / ten) < step / 2 ? 0 : x / ten).toFixed(Math.min(12, decimals)).replace("-", "−")));
      if (values.length * (1.8 + 0.56 * Math.max(...labels.map((l) => l.length))) <= room) break;
    }
    const [bottom, top] = field.y.at, out = [];
    values.forEach((value, k) => {
      const x = Math.round(this.out(placeOf(this.x, value)));
      if (grid) {
        const line = grid.cloneNode();
        line.setAttribute("d", `M${x} ${top}L${x} ${bottom}`);
        out.push(line);
      }
      if (label) {
        const text = label.cloneNode();
        text.setAttribute("x", x);
        text.textContent = labels[k];
        out.push(text);
      }
    });
    return out;
  }

  // The marker that catches a cursor, if one does. A series of markers alone is read where the pointer is, one with a line at any height.
  caught(px, py) {
    const reach = CATCH * this.unit;
    let best = null;
    for (const field of this.fields) {
      for (const curve of field.curves) {
        const alone = curve.strokes.length === 0 && py !== null;
        for (const [x, y] of curve.markers) {
          const away = Math.hypot(this.out(x) - px, alone ? y - py : 0);
          if (this.inside(x) && away <= reach && !(best?.away <= away)) best = { away, x, y, curve, field };
        }
      }
    }
    return best;
  }

  // Smallest and largest ordinate of a curve at a place: of the stroke that passes, or of all that stand in one pixel there.
  extent(curve, place) {
    const half = 0.5 * this.unit / this.scale;
    let low = Infinity, high = -Infinity, dense = [];
    const take = (y) => { low = Math.min(low, y); high = Math.max(high, y); };
    for (const points of curve.strokes) {
      for (let k = 0; k + 3 < points.length; k += 2) {
        const x0 = points[k], y0 = points[k + 1], x1 = points[k + 2], y1 = points[k + 3];
        if (Math.abs(x0 - place) <= half) dense.push(y0);
        if (Math.min(x0, x1) <= place && place <= Math.max(x0, x1)) {
          if (x0 === x1) { take(y0); take(y1); } else take(y0 + (place - x0) / (x1 - x0) * (y1 - y0));
        }
      }
    }
    if (dense.length >= 3) dense.forEach(take);
    return low <= high ? [low, high] : null;
  }

  // What stands under a cursor.
  read(px, py) {
    const caught = this.caught(px, py);
    const place = caught ? caught.x : Math.min(Math.max(this.back(px), this.shown[0]), this.shown[1]);
    const across = caught ? 1 : this.unit / this.scale;
    const rows = [], dots = [];
    for (const field of this.fields) {
      const { y } = field;
      for (const curve of field.curves) {
        let found = curve === caught?.curve ? [caught.y, caught.y] : null;
        const exact = curve.markers.find(([x]) => x === place);
        if (!found && curve.strokes.length) found = exact ? [exact[1], exact[1]] : this.extent(curve, place);
        if (!found) continue;
        const step = (p) => stepAt(y, p, exact || curve === caught?.curve ? 1 : this.x.near);
        const write = (p) => y.names ? y.names[Math.round(valueAt(y, p))] ?? "" : resolved(valueAt(y, p), step(p));
        const [a, b] = y.at[0] > y.at[1] ? [found[1], found[0]] : found;
        rows.push([curve.colour, reading(curve.name, a, b, y.unit, write)]);
        dots.push(...found.map((p) => [place, p, curve.colour]));
      }
    }
    const value = resolved(valueAt(this.x, place), stepAt(this.x, place, across));
    return { place, rows, dots, head: [this.x.name, value, this.x.unit].filter(Boolean).join(" ") };
  }

  show(px, py) {
    if (px < this.range[0] - CATCH * this.unit || px > this.range[1] + CATCH * this.unit) return this.hide();
    const { place, rows, dots, head } = this.read(px, py);
    this.at = this.out(place);
    this.cursor?.remove();
    this.cursor = draw(this.svg, "g", { class: "cursor" });
    for (const { y } of this.fields) draw(this.cursor, "path", { d: `M${this.at} ${y.at[0]}L${this.at} ${y.at[1]}` });
    for (const [x, y, colour] of dots) draw(this.cursor, "circle", { cx: this.out(x), cy: y, r: 3.5 * this.unit, style: `fill:var(--s${colour})` });
    const said = [head, ...rows.map(([, text]) => text)].join("; ");
    if (said !== this.said) {
      this.readout.replaceChildren();
      make(this.readout, "b", { textContent: head });
      for (const [colour, text] of rows) make(this.readout, "span", { textContent: text }).style.setProperty("--c", `var(--s${colour})`);
      if (this.button.hidden && py !== null) make(this.readout, "small", { textContent: "drag to enlarge" });
    }
    this.said = said;
    this.readout.hidden = false;
  }
  hide() {
    this.cursor?.remove();
    this.band?.remove();
    this.said = this.cursor = this.band = null;
    this.readout.hidden = true;
  }

  // The stretch that a drag has passed.
  drag(from, to) {
    const [bottom] = this.fields.at(-1).y.at, top = this.fields[0].y.at[1];
    this.band ??= draw(this.svg, "rect", { class: "stretch" });
    for (const [key, value] of Object.entries({ x: Math.min(from, to), width: Math.abs(to - from), y: top, height: bottom - top })) this.band.setAttribute(key, value);
  }

  key(event) {
    const [left, right] = this.range, at = this.cursor ? this.at : (left + right) / 2, wide = right - left;
    const steps = event.shiftKey ? 10 : 1;
    const move = (sign) => {
      const marks = this.fields.flatMap((f) => f.curves.flatMap((c) => c.markers.map(([x]) => x))).filter((x) => this.inside(x)).map((x) => this.out(x));
      const next = sign > 0 ? Math.min(...marks.filter((x) => x > at + 1)) : Math.max(...marks.filter((x) => x < at - 1));
      const to = this.cursor && Number.isFinite(next) ? next : Math.min(right, Math.max(left, at + sign * steps * STEP * wide));
      this.show(to, null);
    };
    const zoom = (factor) => {
      const middle = this.back(at), half = (this.shown[1] - this.shown[0]) / factor / 2;
      this.zoom([middle - half, middle + half]);
      this.show(this.out(middle), null);
    };
    const keys = {
      ArrowLeft: () => move(-1), ArrowRight: () => move(1), Home: () => this.show(left, null), End: () => this.show(right, null),
      "+": () => zoom(2), "=": () => zoom(2), "-": () => zoom(0.5),
      Escape: () => { if (this.button.hidden) this.hide(); else this.zoom(this.range); },
    };
    if (!keys[event.key] || event.ctrlKey || event.metaKey || event.altKey) return;
    keys[event.key]();
    event.preventDefault();
  }
}

for (const svg of document.querySelectorAll("svg[data-x]")) {
  // A figure that nobody touches costs nothing.
  let built = null, pressed = null;
  const chart = () => (built ??= new Chart(svg));
  const place = (event) => {
    const box = svg.getBoundingClientRect(), unit = chart().unit;
    return [(event.clientX - box.left) * unit, (event.clientY - box.top) * unit];
  };
  svg.tabIndex = 0;
  svg.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    pressed = { at: place(event)[0], moved: false };
    svg.setPointerCapture(event.pointerId);
    chart().show(...place(event));
  });
  svg.addEventListener("pointermove", (event) => {
    const [px, py] = place(event);
    if (pressed) pressed.moved ||= Math.abs(px - pressed.at) > DRAG * chart().unit;
    chart().show(px, py);
    if (pressed?.moved) chart().drag(pressed.at, px);
  });
  svg.addEventListener("pointerup", (event) => {
    if (pressed?.moved) {
      const ends = [pressed.at, place(event)[0]].map((px) => chart().back(Math.min(Math.max(px, chart().range[0]), chart().range[1])));
      chart().zoom(ends.sort((a, b) => a - b));
    }
    pressed = null;
  });
  svg.addEventListener("pointercancel", () => { pressed = null; built?.hide(); });
  svg.addEventListener("pointerleave", (event) => { if (event.pointerType === "mouse" && !pressed) built?.hide(); });
  svg.addEventListener("dblclick", () => chart().zoom(chart().range));
  svg.addEventListener("focus", () => { if (svg.matches(":focus-visible")) chart().show((chart().range[0] + chart().range[1]) / 2, null); });
  svg.addEventListener("blur", () => built?.hide());
  svg.addEventListener("keydown", (event) => chart().key(event));
}
