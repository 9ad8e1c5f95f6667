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
