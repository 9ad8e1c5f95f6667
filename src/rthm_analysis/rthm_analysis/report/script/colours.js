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
