// Curves that move to the left as time goes on: one drawing, its legend with the newest values.
const SVG = "http://www.w3.org/2000/svg";
const LEFT = 58, RIGHT = 8, TOP = 8, BOTTOM = 22;

export function draw(name, attributes = {}, parent = null) {
  const element = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  if (parent) parent.append(element);
  return element;
}

export function digits(value, count = 3) {
  if (value === null || value === undefined) return "–";
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size < 1e-9) return "0";
  const text = size >= 1e5 || size < 1e-4 ? value.toExponential(count - 1) : String(Number(value.toPrecision(count)));
  return text.replace("-", "−");
}

// A value that changes ten times a second: always as many digits, so that nothing jumps.
export function steady(value) {
  if (value === null || value === undefined) return "–";
  const size = Math.abs(value);
  const text = size < 1e-9 ? "0.00" : size >= 1e5 || size < 1e-4 ? value.toExponential(2) : value.toPrecision(3);
  return (size >= 1e3 && size < 1e5 ? value.toFixed(0) : text).replace("-", "−");
}

// Distances of lines of a grid: 1, 2 or 5 times a power of ten, about `lines` of them.
function spacing(range, lines) {
  const raw = range / lines, power = 10 ** Math.floor(Math.log10(raw));
  return power * ([1, 2, 5, 10].find((one) => one * power >= raw));
}

export class Curves {
  // series: [{label, column, look}], `look` being classes of the style.
  constructor(place, title, unit, series, span) {
    Object.assign(this, { title, unit, series, span, rows: [] });
    this.svg = draw("svg", { role: "img" });
    this.grid = draw("g", {}, this.svg);
    const legend = document.createElement("ul");
    for (const one of series) {
      one.path = draw("path", { class: `curve ${one.look}` }, this.svg);
      const item = document.createElement("li"), key = draw("svg", { "aria-hidden": "true" });
      draw("line", { x1: 0, x2: 26, y1: 5, y2: 5, class: one.look, "stroke-width": 3 }, key);
      one.value = document.createElement("b");
      item.append(key, one.label, one.value);
      legend.append(item);
    }
    place.replaceChildren(this.svg, legend);
  }

  add(rows) {
    this.rows.push(...rows);
    const end = this.rows.at(-1)?.[0] ?? 0;
    const first = this.rows.findIndex((row) => row[0] >= end - this.span);
    if (first > 0) this.rows.splice(0, first);
  }

  show() {
    const width = this.svg.clientWidth, height = this.svg.clientHeight;
    if (!width || !this.rows.length) return;
    const end = Math.max(this.rows.at(-1)[0], this.span), begin = end - this.span;
    const [low, high] = this.range();
    const x = (t) => LEFT + ((t - begin) / this.span) * (width - LEFT - RIGHT);
    const y = (v) => TOP + ((high - v) / (high - low)) * (height - TOP - BOTTOM);
    this.lines(x, y, begin, end, low, high, width, height);
    for (const one of this.series) {
      one.path.setAttribute("d", path(this.rows, one.column, x, y));
      one.value.textContent = `${steady(this.rows.at(-1)[one.column])} ${this.unit}`;
    }
    const told = this.series.map((one) => `${one.label} ${one.value.textContent}`);
    this.svg.setAttribute("aria-label", `${this.title} over the last ${this.span} s; now ${told.join(", ")}`);
  }

  range() {
    let low = Infinity, high = -Infinity;
    for (const row of this.rows)
      for (const { column } of this.series) {
        const value = row[column];
        if (value !== null) { low = Math.min(low, value); high = Math.max(high, value); }
      }
    if (low > high) return [-1, 1];
    const room = 0.06 * (high - low) || 0.5 * Math.abs(high) || 1;
    return [low - room, high + room];
  }

  lines(x, y, begin, end, low, high, width, height) {
    this.grid.replaceChildren();
    const up = spacing(high - low, 4), along = spacing(this.span, width < 500 ? 4 : 8);
    for (let v = Math.ceil(low / up) * up; v <= high; v += up) {
      draw("line", { class: "grid", x1: LEFT, x2: width - RIGHT, y1: y(v), y2: y(v) }, this.grid);
      draw("text", { x: LEFT - 8, y: y(v) + 4, "text-anchor": "end" }, this.grid).textContent = digits(v);
    }
    for (let t = Math.ceil(begin / along) * along; t <= end; t += along) {
      draw("line", { class: "grid", x1: x(t), x2: x(t), y1: TOP, y2: height - BOTTOM }, this.grid);
      const text = draw("text", { x: x(t), y: height - 6, "text-anchor": t + along > end ? "end" : "middle" }, this.grid);
      text.textContent = t + along > end ? `${digits(t, 6)} s` : digits(t, 6);
    }
  }
}

function path(rows, column, x, y) {
  let text = "", pen = "M";
  for (const row of rows) {
    const value = row[column];
    if (value === null) { pen = "M"; continue; }
    text += `${pen}${x(row[0]).toFixed(1)} ${y(value).toFixed(1)}`;
    pen = "L";
  }
  return text;
}
