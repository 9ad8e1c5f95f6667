// Cursors: two lines over all plots of one axis of time and, under each plot, what its curves are at both.
const STEPS = 500, LARGE = 10; // arrow keys: steps in what is shown, and how many of them with shift
const NONE = "\u2013", MINUS = "\u2212";
const marks = (view, type) => view.model.center.filter((one) => one.type === type && one.name);
const unit = (axis) => axis.axis_label.match(/\(([^)]*)\)$/)?.[1] ?? "";
const digits = (value) => Number.isFinite(value) ? String(Number(value.toPrecision(4))).replaceAll("-", MINUS) : NONE;
const seconds = (value) => value.toFixed(4).replace("-", MINUS);

// Height of a curve as it is drawn; NaN where it is not.
function height(curve, t) {
  const { data } = curve.data_source, [x, y] = ["x", "y"].map((key) => data instanceof Map ? data.get(key) : data[key]);
  let low = 0, high = x.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (x[middle] > t) high = middle;
    else low = middle + 1;
  }
  if (low === x.length) return x[low - 1] === t ? y[low - 1] : NaN;
  return low ? y[low - 1] + ((y[low] - y[low - 1]) * (t - x[low - 1])) / (x[low] - x[low - 1]) : NaN;
}

function row(kind, cells) {
  const made = document.createElement("tr");
  made.append(...cells.map((text) => Object.assign(document.createElement(kind), { textContent: text })));
  return made;
}

function reading(view) {
  const [t1, t2] = marks(view, "Span").map((one) => one.location), apart = t2 - t1;
  const made = document.createElement("p"), table = document.createElement("table"), of = unit(view.model.left[0]);
  const times = [`t1 = ${seconds(t1)} s`, `t2 = ${seconds(t2)} s`, `t2 ${MINUS} t1 = ${seconds(apart)} s`];
  made.textContent = [...times, `1/(t2 ${MINUS} t1) = ${digits(1 / apart)} Hz`].map((text) => text.replaceAll(" ", "\u00a0")).join(", ");
  table.append(row("th", ["", `at t1 (${of})`, `at t2 (${of})`, `difference (${of})`]));
  for (const one of view.model.renderers.filter((curve) => curve.name && curve.visible)) {
    const [at1, at2] = [height(one, t1), height(one, t2)];
    table.append(row("td", [one.name, ...[at1, at2, at2 - at1].map(digits)]));
  }
  return [made, table];
}

function slider(view, line) {
  const label = document.createElement("label"), made = document.createElement("input"), { x_range } = view.model;
  const move = (t) => { line.location = Math.min(Math.max(t, x_range.start), x_range.end); };
  Object.assign(made, { type: "range", step: "any" });
  made.setAttribute("aria-label", `${line.name}, ${title(view)}`);
  made.addEventListener("input", () => move(Number(made.value)));
  made.addEventListener("keydown", (event) => {
    const way = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    if (!way) return;
    event.preventDefault();
    move(line.location + (way * (event.shiftKey ? LARGE : 1) * (x_range.end - x_range.start)) / STEPS);
  });
  label.append(line.name, made);
  const show = () => {
    const { left, width } = view.frame.bbox;
    [label.style.width, made.style.width] = [`${left + width + 8}px`, `${width + 16}px`]; // the thumb is under its line
    Object.assign(made, { min: x_range.start, max: x_range.end, value: line.location });
    made.setAttribute("aria-valuetext", `${seconds(line.location)} s`);
  };
  return [label, show];
}

function show(view, shown) {
  const { start, end } = view.model.x_range, [lines, names] = ["Span", "Label"].map((type) => marks(view, type));
  const outside = lines.some(({ location }) => location <= start || location >= end);
  lines.forEach((line, k) => {
    if (shown && outside) line.location = start + ((k + 1) * (end - start)) / 3;
    line.visible = names[k].visible = shown;
  });
}

for (const view of views.filter((one) => marks(one, "Span").length)) {
  const [lines, names] = ["Span", "Label"].map((type) => marks(view, type));
  const below = document.createElement("div"), told = document.createElement("div");
  const sliders = lines.map((line) => slider(view, line));
  const toggle = button("cursors", `cursors, ${title(view)}`, () => show(view, !lines[0].visible));
  const update = () => {
    toggle.setAttribute("aria-expanded", String(lines[0].visible));
    below.hidden = !lines[0].visible;
    if (below.hidden) return;
    sliders.forEach(([, place]) => place());
    told.replaceChildren(...reading(view));
  };
  below.className = "cursors";
  below.append(...sliders.map(([label]) => label), told);
  view.el.closest("figure").querySelector(".bar summary").parentElement.before(toggle);
  view.el.closest(".live").after(below);
  for (const one of [...lines, view.model.x_range, ...view.model.renderers]) one.change.connect(update);
  lines.forEach((line, k) => line.change.connect(() => { names[k].x = line.location; }));
  new ResizeObserver(update).observe(view.el);
  update();
}
