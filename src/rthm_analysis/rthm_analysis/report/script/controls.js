// A finger scrolls the page; it zooms once that has been asked for.
const tool = (view, type) => view.model.toolbar.tools.find((one) => one.type === type);
const touched = matchMedia("(pointer: coarse)").matches;

function button(words, label, press) {
  const made = document.createElement("button");
  made.type = "button";
  made.textContent = words;
  if (label) made.setAttribute("aria-label", label);
  made.addEventListener("click", () => press(made));
  return made;
}

function drags(view) {
  const buttons = [["BoxZoomTool", "drag: zoom"], ["PanTool", "drag: move"]].map(([type, words]) => {
    const one = tool(view, type);
    const made = button(words, null, () => {
      const wanted = !one.active;
      for (const other of ["BoxZoomTool", "PanTool"]) tool(view, other).active = false;
      one.active = wanted;
      show();
    });
    return [one, made];
  });
  const show = () => buttons.forEach(([one, made]) => made.setAttribute("aria-pressed", String(one.active)));
  if (touched) buttons.forEach(([one]) => { one.active = false; });
  show();
  return buttons.map(([, made]) => made);
}

function moves(view) {
  const range = view.model.x_range;
  const [first, last] = range.bounds ? [range.start, range.end] : [-Infinity, Infinity];
  const zoom = (share) => () => {
    const { start, end } = range, less = share * (end - start);
    range.setv({ start: start + less, end: end - less });
  };
  const move = (share) => () => { // at an end as much as is left, so that the length stays
    const { start, end } = range, by = Math.min(Math.max(share * (end - start), first - start), last - end);
    range.setv({ start: start + by, end: end + by });
  };
  return [
    button("+", "zoom in", zoom(0.25)),
    button("\u2212", "zoom out", zoom(-0.5)),
    button("\u2190", "move left", move(-0.25)),
    button("\u2192", "move right", move(0.25)),
    button("all", "show all", () => view.reset()),
  ];
}

function curves(view) {
  const { renderers } = view.model;
  return renderers.filter((one) => one.name).map((one) => {
    const same = renderers.filter((other) => other.data_source === one.data_source); // dots and line of few samples
    const made = button(one.name, null, () => {
      const shown = !one.visible;
      for (const other of same) other.visible = shown;
    });
    made.setAttribute("aria-pressed", "true");
    one.properties.visible.change.connect(() => made.setAttribute("aria-pressed", String(one.visible)));
    return made;
  });
}

for (const view of views) {
  const bar = document.createElement("div"), more = document.createElement("details");
  const inside = document.createElement("div"), summary = document.createElement("summary");
  summary.textContent = "zoom and curves";
  inside.append(...drags(view), ...moves(view), ...curves(view));
  more.append(summary, inside);
  bar.className = "bar";
  bar.append(
    button("SVG", `${title(view)} as SVG`, () => saveSvg(view)),
    button("CSV", `${title(view)}, as drawn, as CSV`, () => save(named(view, ".csv"), "text/csv", csv(view))),
    more,
  );
  view.el.closest("figure").append(bar);
  new ResizeObserver(() => arrange(view)).observe(view.el);
}
