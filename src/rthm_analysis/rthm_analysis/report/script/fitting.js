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
