// The rig: of every actuator the plant's mass, the wire, the motor, and the mass of the numerical side below.
import { draw, steady } from "./curves.js";

const HEIGHT = 168, SIZE = 44, RAIL = 66, LOWER = 140;

export class Rig {
  constructor(svg, words, pulls, columns) {
    this.svg = svg;
    this.words = words;
    this.reach = 1e-6;
    this.pulls = pulls.map((pull) => ({
      ...pull,
      at: Object.fromEntries(Object.entries({
        plant: pull.plant, numerical: pull.numerical, motor: `${pull.motor}.motor`,
        force: `${pull.motor}.force`, ideal: `${pull.plant}.ideal`,
      }).map(([key, name]) => [key, columns.indexOf(name)])),
    }));
    this.build();
  }

  build() {
    const width = this.width = this.svg.clientWidth || 600;
    this.svg.setAttribute("viewBox", `0 0 ${width} ${HEIGHT * this.pulls.length}`);
    this.svg.replaceChildren();
    this.words.replaceChildren();
    this.pulls.forEach((pull, row) => this.buildOne(pull, draw("g", { transform: `translate(0 ${row * HEIGHT})` }, this.svg)));
  }

  // Centres where all is at rest, px: the masses one above the other, the motor beside the plant's.
  get home() { return { mass: 0.36 * this.width, motor: 0.74 * this.width }; }

  buildOne(pull, group) {
    const { mass, motor } = this.home;
    for (const [y, left, right] of [[RAIL, 8, this.width - 8], [LOWER, 8, 0.62 * this.width]])
      draw("line", { class: "rail", x1: left, x2: right, y1: y, y2: y }, group);
    for (const x of [mass, motor]) draw("line", { class: "zero", x1: x, x2: x, y1: 10, y2: x === mass ? LOWER : RAIL }, group);
    const moving = () => draw("g", { class: "moves" }, group);
    const box = (look, y, label) => {
      const one = moving();
      draw("rect", { class: look, x: -SIZE / 2, y: y - SIZE, width: SIZE, height: SIZE, rx: 4 }, one);
      if (label) draw("text", { class: "name", x: 0, y: y - SIZE / 2 + 5 }, one).textContent = label;
      return one;
    };
    pull.wire = moving();
    draw("line", { class: "wire", x1: 0, x2: 1, y1: RAIL - SIZE / 2, y2: RAIL - SIZE / 2 }, pull.wire);
    pull.interface = draw("line", { class: "interface", y1: RAIL, y2: LOWER - SIZE }, group);
    pull.boxes = {
      ideal: box("ideal", RAIL, ""),
      plant: box("plant", RAIL, pull.plant),
      numerical: box("numerical", LOWER, pull.numerical),
    };
    pull.boxes.motor = moving();
    draw("circle", { class: "motor", cx: 0, cy: RAIL - SIZE / 2, r: 17 }, pull.boxes.motor);
    draw("text", { class: "name", x: 0, y: RAIL - SIZE / 2 + 5 }, pull.boxes.motor).textContent = pull.motor;
  }

  show(row) {
    if (!row) return;
    if (this.svg.clientWidth && this.svg.clientWidth !== this.width) this.build();
    for (const { at } of this.pulls)
      for (const key of ["plant", "numerical", "motor"]) this.reach = Math.max(this.reach, Math.abs(row[at[key]] ?? 0));
    const scale = (0.14 * this.width) / this.reach, told = [];
    for (const pull of this.pulls) {
      const value = (key) => row[pull.at[key]];
      const place = (key) => (key === "motor" ? this.home.motor : this.home.mass) + scale * (value(key) ?? 0);
      for (const [key, box] of Object.entries(pull.boxes)) {
        box.style.transform = `translate(${place(key)}px, 0)`;
        box.style.display = value(key) === null ? "none" : "";
      }
      const from = place("plant") + SIZE / 2, to = place("motor") - 17;
      pull.wire.style.transform = `translate(${from}px, 0) scale(${Math.max(to - from, 1)}, 1)`;
      pull.interface.setAttribute("x1", place("plant"));
      pull.interface.setAttribute("x2", place("numerical"));
      told.push([pull.plant, `${steady(value("plant"))} m`], [pull.numerical, `${steady(value("numerical"))} m`],
        [`motor ${pull.motor}`, `${steady(value("motor"))} m`], [`wire ${pull.motor}`, `${steady(value("force"))} N`]);
    }
    this.tell(told);
  }

  tell(told) {
    this.svg.setAttribute("aria-label", `Rig: ${told.map((one) => one.join(" ")).join(", ")}`);
    told.forEach(([name, value], i) => {
      let item = this.words.children[i];
      if (!item) {
        item = this.words.appendChild(document.createElement("li"));
        item.append(name, document.createElement("b"));
      }
      item.lastChild.textContent = value;
    });
  }
}
