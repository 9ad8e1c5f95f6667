"use strict";
// What a page does: brings its plots to life in the colours of the style sheet, gives each a bar of controls, and draws all again for paper.
(async () => {
  const read = (id) => JSON.parse(document.getElementById(id).textContent);
  const { docs, items } = read("plots");
  await Bokeh.embed.embed_items(docs, items);
  const documents = Bokeh.documents;
  const views = [...Bokeh.index.roots].filter((view) => view.model.toolbar).sort((a, b) => a.el.compareDocumentPosition(b.el) & 4 ? -1 : 1);

  // Colours: every property that has a colour of the palette, with the name of that colour.
  const palette = read("palette");
  const coloured = [];
  for (const doc of documents) for (const model of doc.all_models) for (const property of model) {
    const raw = property.is_unset ? null : property.get_value();
    const colour = raw !== null && typeof raw === "object" && "value" in raw ? raw.value : raw;
    if (typeof colour === "string" && colour in palette) coloured.push([model, property.attr, colour, raw !== colour]);
  }
  const dark = matchMedia("(prefers-color-scheme: dark)");
  const lightOf = new Map(); // of every shade that was painted with
  function paint() {
    const style = getComputedStyle(document.documentElement);
    const shades = Object.fromEntries(Object.entries(palette).map(([light, name]) => [light, style.getPropertyValue(name).trim()]));
    for (const [light, shade] of Object.entries(shades)) lightOf.set(shade, light);
    for (const [model, name, colour, inside] of coloured) {
      const shown = shades[colour];
      model.setv({ [name]: inside ? { value: shown } : shown });
    }
  }
  if (dark.matches) paint();
  dark.addEventListener("change", paint);

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
    const move = (from, to) => () => {
      const { start, end } = range, length = end - start;
      range.setv({ start: start + from * length, end: end + to * length });
    };
    return [
      button("+", "zoom in", move(0.25, -0.25)),
      button("\u2212", "zoom out", move(-0.5, 0.5)),
      button("\u2190", "move left", move(-0.25, -0.25)),
      button("\u2192", "move right", move(0.25, 0.25)),
      button("all", "show all", () => view.reset()),
    ];
  }

  function curves(view) {
    return view.model.renderers.filter((one) => one.name).map((one) => {
      const made = button(one.name, null, () => {
        one.visible = !one.visible;
        made.setAttribute("aria-pressed", String(one.visible));
      });
      made.setAttribute("aria-pressed", "true");
      one.properties.visible.change.connect(() => made.setAttribute("aria-pressed", String(one.visible)));
      return made;
    });
  }

  // Files: a figure as SVG, and what is drawn in it as CSV.
  const named = (view, kind) =>
    `${document.title} ${title(view)}`.toLowerCase().replace(/[^a-z0-9]+/g, "-").replace(/^-|-$/g, "") + kind;

  function save(name, type, text) {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob([text], { type }));
    link.download = name;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10000);
  }

  // A figure fits its width: names of curves beside each other as far as there is room for the longest, the title in lines.
  const measure = document.createElement("canvas").getContext("2d");
  const wide = (text, size, font) => { measure.font = `${size} ${font}`; return measure.measureText(text).width; };
  const asked = new Map(views.map(({ model }) => [model, { height: model.height, title: model.title.text }]));
  const title = (view) => asked.get(view.model).title;

  const full = new Map(); // names of curves, by item of a legend
  function fit(view) {
    const plot = view.model, { height } = asked.get(plot), whole = view.el.getBoundingClientRect().width;
    if (!whole) return;
    const left = Math.min(plot.min_border_left, whole < 500 ? 60 : 86), room = whole - Math.max(left, view.frame.bbox.left) - 14;
    let rows = 0;
    for (const legend of plot.above.filter((one) => one.type === "Legend")) {
      const size = (name) => wide(name, legend.label_text_font_size, legend.label_text_font) + legend.glyph_width + 24;
      const names = legend.items.map((item) => {
        const name = full.get(item) ?? full.set(item, item.label.value ?? String(item.label)).get(item);
        const shown = shortened(name, (one) => size(one) <= room);
        if (shown !== (item.label.value ?? item.label)) item.label = { value: shown };
        return shown;
      });
      const longest = Math.max(...names.map(size));
      legend.ncols = Math.max(1, Math.min(names.length, Math.floor(room / longest)));
      rows = Math.ceil(names.length / legend.ncols) - 1;
    }
    const text = lines(title(view), room, plot.title);
    plot.setv({ min_border_left: left, height: height + 27 * rows + 19 * (text.split("\n").length - 1) });
    plot.title.text = text;
  }

  function arrange(view) {
    fit(view);
    view.compute_layout();
    view.request_repaint();
  }

  // The end of a name says more than its beginning.
  function shortened(name, fits) {
    let shown = name;
    while (shown.length > 8 && !fits(shown)) shown = "\u2026" + shown.slice(2);
    return shown;
  }

  function lines(words, room, { text_font_size, text_font }) {
    return words.split(" ").reduce((told, word) => {
      const line = `${told.slice(told.lastIndexOf("\n") + 1)} ${word}`;
      return told + (wide(line, `bold ${text_font_size}`, text_font) > room ? "\n" : " ") + word;
    });
  }

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

  function saveSvg(view) {
    save(named(view, ".svg"), "image/svg+xml", new XMLSerializer().serializeToString(drawn(view)));
  }

  function columns(view) {
    const [x, y] = [view.model.below[0], view.model.left[0]].map((axis) => axis.axis_label || "");
    return view.model.renderers.filter((one) => one.data_source).flatMap((one) => {
      const data = one.data_source.data, entries = data instanceof Map ? [...data] : Object.entries(data);
      const words = { x, y: `${one.name || title(view)}: ${y}` };
      return entries.map(([key, values]) => [words[key] || `${one.name || title(view)}: ${key}`, Array.from(values)]);
    });
  }

  function csv(view) {
    const cell = (value) => typeof value === "number" ? (Number.isFinite(value) ? String(value) : "")
      : value === undefined ? "" : `"${String(value).replaceAll('"', '""')}"`;
    const told = columns(view), length = Math.max(0, ...told.map(([, values]) => values.length));
    const rows = Array.from({ length }, (_, k) => told.map(([, values]) => cell(values[k])).join(","));
    return [told.map(([name]) => cell(name)).join(","), ...rows].join("\r\n") + "\r\n";
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

  // Paper has its own width: there, each figure is drawn again, as lines that keep sharp, before a page is printed.
  const sheets = [];
  addEventListener("beforeprint", () => {
    document.body.classList.add("paper");
    for (const view of views) {
      const sheet = document.createElement("div");
      sheet.className = "on-paper";
      sheet.attachShadow({ mode: "open" }).append(drawn(view)); // names inside a figure stay its own
      view.el.closest("figure").append(sheet);
      sheets.push(sheet);
    }
    document.body.classList.add("drawn");
  });
  addEventListener("afterprint", () => {
    document.body.classList.remove("paper", "drawn");
    sheets.splice(0).forEach((sheet) => sheet.remove());
    views.forEach(arrange);
  });
  document.documentElement.dataset.ready = "true";
})();
