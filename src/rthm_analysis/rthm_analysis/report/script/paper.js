// Paper has its own width: there, each figure is drawn again, as lines that keep sharp, before a page is printed.
const sheets = [];
addEventListener("beforeprint", () => {
  document.body.classList.add("paper");
  for (const view of views.filter((one) => one.el.getBoundingClientRect().width)) { // what is folded stays folded
    const sheet = document.createElement("div");
    sheet.className = "on-paper";
    sheet.attachShadow({ mode: "open" }).append(drawn(view)); // names inside a figure stay its own
    view.el.closest(".live").after(sheet);
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
