// What the dashboard tells, ten times a second, put on the page. Nothing is computed here about the test.
import { Curves, digits, draw } from "./curves.js";
import { Rig } from "./rig.js";

const token = new URLSearchParams(location.search).get("token") ?? "";
const $ = (id) => document.getElementById(id);
const LOOKS = ["c0", "c1", "c2", "c3", "c4", "c5", "c6", "c7"];
const ms = (seconds) => (seconds === null ? "–" : `${digits(1000 * seconds)} ms`);
const percent = (part) => (part === null ? "–" : `${digits(100 * part)} %`);
let drawings = [], rig = null, newest = null, ran = false;

function text(element, words) {
  if (element.textContent !== words) element.textContent = words;
}

// Curves for a test; its columns are known once.
function layout(test) {
  const column = (name) => test.columns.indexOf(name);
  const motors = test.pulls.map((pull) => pull.motor), numerical = [...new Set(test.pulls.map((pull) => pull.numerical))];
  const motion = test.dofs.flatMap((dof, i) => [
    { label: dof, column: column(dof), look: LOOKS[2 * i % 8] },
    { label: `${dof}, ideal system`, column: column(`${dof}.ideal`), look: test.dofs.length > 1 ? `${LOOKS[2 * i % 8]} dashed` : "c7 dashed" },
  ]).concat(numerical.map((dof, i) => ({ label: dof, column: column(dof), look: LOOKS[(2 * i + 1) % 8] })));
  const force = motors.flatMap((motor, i) => [
    { label: `${motor}, reference F_d`, column: column(`${motor}.reference`), look: `${LOOKS[(2 * i + 1) % 8]} dashed` },
    { label: `${motor}, force F`, column: column(`${motor}.force`), look: LOOKS[(2 * i + 2) % 8] },
  ]);
  const energy = test.energies.slice(1).map((term, i) => ({ label: term, column: i + 1, look: LOOKS[i] }));
  drawings = [
    [new Curves($("motion"), "Motion", "m", motion, test.window), 0],
    [new Curves($("force"), "Force", "N", force, test.window), 0],
    [new Curves($("energy"), "Energy", "J", energy, test.window), 1],
  ];
  rig = new Rig($("rig"), $("rig-words"), test.pulls, test.columns);
  newest = null;
  ran = false;
  document.body.classList.add("test");
}

function now(shown) {
  head(shown);
  report(shown.report);
  shown.rows[0].length && (newest = shown.rows[0].at(-1));
  for (const [curves, which] of drawings) curves.add(shown.rows[which]);
  redraw();
  if (shown.cost !== undefined) text($("cost"), `This page's server takes ${digits(100 * shown.cost, 2)} % of a processor core, at the lowest priority.`);
  if (!shown.links) return;
  ran ||= shown.state === "running";
  facts(shown);
  text($("motion-words"), shown.no_ideal ? `No ideal system beside it: ${shown.no_ideal}.` : "Measured, beside the ideal system: the same test without delays, holds and motor.");
  table($("links"), shown.links, link);
  table($("limits"), shown.limits, limit);
  text($("limits-words"), shown.limits.length ? "Bar: now. Mark: largest so far." : "The spec has no limits on recorded signals.");
  log(shown.events);
}

function redraw() {
  for (const [curves] of drawings) curves.show();
  rig?.show(newest);
}

function head(shown) {
  text($("words"), shown.words);
  $("words").classList.toggle("bad", shown.state === "aborted");
  text($("at"), shown.at === undefined || shown.at === null ? "–" : `${Math.max(shown.at, 0).toFixed(1)} s`);
  text($("duration"), shown.duration ? `of ${digits(shown.duration, 6)} s` : "");
  $("abort").disabled = !shown.can_abort || !["starting", "running"].includes(shown.state);
}

function facts(shown) {
  const missed = shown.clocks.reduce((sum, clock) => sum + clock.missed, 0);
  const per = shown.clocks.map((clock) => `${clock.name} ${clock.missed}`).join(", ");
  const lost = shown.links.reduce((sum, link) => sum + (link.lost ?? 0), 0);
  const late = shown.links.reduce((sum, link) => sum + (link.late ?? 0), 0);
  const told = shown.errors.map((error) => [
    `${error.dof} against the ideal system`, percent(error.nrmse), `so far; at most ${digits(error.max)} m`, "",
  ]);
  told.push(["Energy from the loop's errors", `${digits(shown.energy.E_err)} J`, "E_num + E_ff + E_fx", ""]);
  told.push(["Missed ticks", String(missed), per || "not reported yet", missed ? "bad" : "good"]);
  told.push(["Late and lost samples", `${late}, ${lost}`, "all links", late + lost ? "bad" : "good"]);
  const without = shown.without_priority;
  if (without.length) told.push(["Real-time priority", "none", without.join(", "), ""]);
  while ($("facts").children.length > told.length) $("facts").lastChild.remove();
  told.forEach(([label, value, words, level], i) => {
    const fact = $("facts").children[i] ?? $("facts").appendChild(made("div", "fact", ["small", "b", "span"]));
    fact.className = `fact ${level}`;
    [label, value, words].forEach((one, part) => text(fact.children[part], one));
  });
}

function made(name, look, parts) {
  const element = document.createElement(name);
  element.className = look;
  element.append(...parts.map((part) => document.createElement(part)));
  return element;
}

// One row for each entry; `cells` gives name, bar and [heading, words, bad] of the others.
function table(body, entries, cells) {
  while (body.children.length > entries.length) body.lastChild.remove();
  entries.forEach((entry, i) => {
    const { name, bar, others } = cells(entry);
    const row = body.children[i] ?? body.appendChild(document.createElement("tr"));
    if (!row.children.length) {
      row.append(document.createElement("th"), document.createElement("td"), ...others.map(() => document.createElement("td")));
      row.children[0].scope = "row";
      row.children[1].className = "gauge";
      row.children[1].append(draw("svg", { viewBox: "0 0 100 18", preserveAspectRatio: "none", role: "img" }));
    }
    text(row.children[0], name);
    paint(row.children[1].firstChild, bar);
    others.forEach(([heading, words, bad], k) => {
      const cell = row.children[k + 2];
      cell.dataset.name = heading;
      cell.classList.toggle("bad", Boolean(bad));
      text(cell, words);
    });
  });
}

// A bar: shares of its length from 0 to 1.
function paint(svg, { value, over, room, mark, peak, words }) {
  const x = (share) => 100 * Math.min(Math.max(share, 0), 1);
  svg.setAttribute("aria-label", words);
  svg.replaceChildren();
  draw("rect", { class: "frame", x: 0.5, y: 2, width: 99, height: 14 }, svg);
  if (room) draw("rect", { class: "room", x: x(room[0]), y: 2, width: x(room[1]) - x(room[0]), height: 14 }, svg);
  draw("rect", { class: over ? "over" : "value", x: 0, y: 6, width: x(value), height: 6 }, svg);
  if (mark !== undefined) draw("line", { class: "mark", x1: x(mark), x2: x(mark), y1: 1, y2: 17 }, svg);
  if (peak !== undefined) draw("line", { class: "peak", x1: x(peak), x2: x(peak), y1: 3, y2: 15 }, svg);
}

function link(one) {
  const whole = 1.6 * Math.max(one.oldest, 1e-3), over = (age) => age !== null && age > one.oldest + 1e-3;
  return {
    name: one.name,
    bar: {
      value: (one.max ?? 0) / whole, over: over(one.max), mark: one.delay / whole,
      room: [one.delay / whole, one.oldest / whole], words: `${one.name}: ${ms(one.max)} old at most, specified ${ms(one.delay)}`,
    },
    others: [
      ["specified", ms(one.delay)], ["mean", ms(one.mean)], ["largest", ms(one.max), over(one.max)],
      ["largest so far", ms(one.worst), over(one.worst)], ["late", one.late ?? "–", one.late], ["lost", one.lost ?? "–", one.lost],
    ],
  };
}

function limit(one) {
  const share = one.now / one.allowed, peak = one.peak / one.allowed;
  return {
    name: one.name.replace("_", " "),
    bar: { value: share, over: share > 0.8, peak, words: `${percent(share)} of the limit now, ${percent(peak)} at most` },
    others: [
      ["now", `${digits(one.now)} ${one.unit}`], ["largest", `${digits(one.peak)} ${one.unit}`, peak > 0.8],
      ["allowed", `${digits(one.allowed)} ${one.unit}`],
    ],
  };
}

function log(events) {
  if (events.length < $("log").children.length) $("log").replaceChildren();
  for (const event of events.slice($("log").children.length)) {
    const line = made("li", "", ["span"]);
    line.firstChild.textContent = event.at === null ? "" : `${event.at.toFixed(3)} s`;
    line.append(event.words);
    $("log").append(line);
  }
}

// The page becomes the report of the test that it has shown; who comes back to it stays.
function report(told) {
  const link = $("report-link");
  text($("report-words"), told?.words ?? "");
  link.hidden = !told?.ready;
  link.href = `report?token=${token}`;
  if (told?.ready && ran) {
    ran = false;
    setTimeout(() => location.assign(link.href), 1500);
  }
}

$("abort").addEventListener("click", async () => {
  text($("abort-words"), "Requesting the abort.");
  try {
    const answer = await fetch("abort", { method: "POST", headers: { "X-Token": token } });
    text($("abort-words"), answer.ok ? "Abort requested." : await answer.text());
  } catch {
    text($("abort-words"), "Not sent! Press the key a in the terminal of the run.");
  }
});

window.addEventListener("resize", redraw);

const source = new EventSource(`events?token=${token}`);
source.addEventListener("layout", (event) => layout(JSON.parse(event.data)));
source.addEventListener("now", (event) => now(JSON.parse(event.data)));
source.addEventListener("error", () => {
  text($("words"), "No answer from the dashboard server: values are stale.");
  $("words").classList.add("bad");
  $("abort").disabled = true;
});
