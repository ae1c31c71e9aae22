// The answer in one look: the next best drives, the smallest margins and the torque-speed field, above the report.

import { tick } from "./compare.js";
import { element } from "./dom.js";
import { bar } from "./headline.js";

const place = document.getElementById("glance"), jump = document.getElementById("jump");
const [margins, others] = place.querySelectorAll(".list");
const OTHERS = 5;
const ROW = [["summary", "Summary"], ["checks", "Checks"], ["over-time", "Cycle"], ["heat", "Heat"], ["energy", "Energy"], ["loop", "Loop"], ["closed_loop", "Loop"], ["candidates", "Candidates"], ["datasheets", "Data"]];

/** The next best, each with a box by which it is compared, and the checks that decide. */
export function rank(piece) {
  place.hidden = piece.machine || !piece.sets.length;
  if (place.hidden) return;
  const next = piece.sets.slice(1, 1 + OTHERS);
  others.parentElement.hidden = !next.length;
  others.replaceChildren(...next.map(line));
  margins.replaceChildren(...piece.margins.map((one) => element("li", {}, element("span", { textContent: one.title }), element("span", { className: "figure", textContent: one.said }), bar(one.margin, one.status))));
}

export function hide() { place.hidden = true; }

function line(one) {
  const price = one.figures.price === "unknown" ? "" : one.figures.price.replace(/\.\d\d /, " ");
  const figures = [["mass", one.figures.mass], ["price", price], ["margin", one.tight?.said ?? ""]];
  const name = element("label", { title: one.label }, tick(one), ` ${one.name}`, element("small", { textContent: ` ${one.numbers}` }));
  const status = one.status === "pass" ? "" : element("span", { className: `pill ${one.status}`, textContent: one.status });
  return element("li", {}, name, status, ...figures.map(([name, text]) => element("span", { className: `figure ${name}`, textContent: text })));
}

/** A row of the sections that are there, which leads to them. */
export function row(sections) {
  const there = new Set(sections.map((one) => one.name));
  jump.replaceChildren(...ROW.filter(([name]) => there.has(name)).map(([name, title]) => {
    const made = element("a", { href: `#${name}`, textContent: title });
    made.addEventListener("click", (event) => {
      event.preventDefault();
      const head = document.querySelector(`#report [data-name="${name}"] > *`);
      head?.focus({ preventScroll: true });
      head?.scrollIntoView();
    });
    return made;
  }));
}
