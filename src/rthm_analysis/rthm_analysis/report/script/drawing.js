// Drawing: a plot as SVG, light and sharp, for paper and for a file.
// The samples of a legend come as pixels in the colours of the screen; as lines and dots they keep sharp.
function sharpen(svg, plot) {
  const items = plot.above.filter((one) => one.type === "Legend").flatMap((legend) => legend.items);
  [...svg.querySelectorAll("image")].forEach((image, k) => {
    const { glyph } = items[k].renderers[0], [x, y, w, h] = ["x", "y", "width", "height"].map((name) => +image.getAttribute(name));
    const plain = (value) => value?.value ?? value, line = glyph.type === "Line";
    const made = document.createElementNS(svg.namespaceURI, line ? "line" : "circle");
    const shape = line ? { x1: x + 1, x2: x + w - 1, y1: y + h / 2, y2: y + h / 2 } : { cx: x + w / 2, cy: y + h / 2, r: 3.5 };
    const look = line
      ? { stroke: plain(glyph.line_color), "stroke-width": plain(glyph.line_width), "stroke-dasharray": glyph.line_dash.join?.(" ") ?? "" }
      : { fill: plain(glyph.fill_color) };
    for (const [name, value] of Object.entries({ ...shape, ...look })) made.setAttribute(name, value);
    if (image.hasAttribute("transform")) made.setAttribute("transform", image.getAttribute("transform"));
    image.replaceWith(made);
  });
}

// Paper is light, and a figure that leaves the page is, too.
const hex = (colour) => colour?.replace(/^rgb\((\d+),(\d+),(\d+)\)$/, (_, ...parts) =>
  "#" + parts.slice(0, 3).map((part) => Number(part).toString(16).padStart(2, "0")).join(""));
function lighten(svg) {
  for (const one of svg.querySelectorAll("[fill], [stroke]")) for (const name of ["fill", "stroke"]) {
    const colour = lightOf.get(hex(one.getAttribute(name)));
    if (colour) one.setAttribute(name, colour);
  }
}

function drawn(view) {
  arrange(view);
  const svg = view.export("svg", false).ctx.get_svg().cloneNode(true);
  sharpen(svg, view.model);
  lighten(svg);
  svg.style.cssText = "display: block; max-width: 100%; height: auto";
  svg.setAttribute("viewBox", `0 0 ${view.bbox.width} ${view.bbox.height}`);
  return svg;
}
