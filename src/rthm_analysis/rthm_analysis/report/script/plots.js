// Plots: brought to life, in the order of the page.
const read = (id) => JSON.parse(document.getElementById(id).textContent);
const { docs, items } = read("plots");
await Bokeh.embed.embed_items(docs, items);
const documents = Bokeh.documents;
const views = [...Bokeh.index.roots].filter((view) => view.model.toolbar).sort((a, b) => a.el.compareDocumentPosition(b.el) & 4 ? -1 : 1);
