// Stretches of a figure over which the same drive is the best: a band of colours, and a line for each.

import { element } from "./dom.js";

const COLOURS = 6, NAMED = 0.16; // share of a band from which a drive's name has room on it
const known = new Map(); // drives by their names, in the order in which they were met: one drive, one colour

export const same = (a, b) => a.status === b.status && (a.label === b.label || a.status === "fail");
export const passes = (each) => each.status !== "fail" && each.status !== "wrong";

/** Neighbouring places with the same best drive, of points by their value. */
export function stretches(points) {
  const list = [];
  for (const [value, point] of [...points].sort(([a], [b]) => a - b)) {
    const last = list.at(-1);
    if (last && same(last, point)) last.to = value;
    else list.push({ ...point, from: value, to: value });
  }
  return list;
}

/** The class of a drive's colour. */
export function colour(each) {
  if (!passes(each)) return each.status === "wrong" ? "wait" : "none";
  if (!known.has(each.label)) known.set(each.label, known.size % COLOURS);
  return `s${known.get(each.label)}`;
}

/** Draws both; `text` writes a value, `rejected` says by the end of a stretch why its drive is not the best beyond it. */
export function draw({ band, list, low, high, points, rejected, text }) {
  const found = stretches(points);
  band.replaceChildren(...found.map((each, n) => {
    const start = n ? (found[n - 1].to + each.from) / 2 : low, end = n + 1 < found.length ? (each.to + found[n + 1].from) / 2 : each.to;
    const share = (end - start) / (high - low), name = share >= NAMED && passes(each) ? each.name ?? "" : "";
    const piece = element("i", { className: colour(each), title: said(each, text) }, ...(name ? [element("span", { textContent: name })] : []));
    piece.style.width = `${100 * share}%`;
    return piece;
  }));
  list.replaceChildren(...found.map((each, n) => line(each, colour(each), n + 1 < found.length, rejected.get(each.to), text)));
  return found.length;
}

const reach = (each, text) => (each.from === each.to ? text(each.from) : `${text(each.from)} to ${text(each.to)}`);
export const best = (each) => (passes(each) ? each.label : each.status === "wrong" ? each.said : "no drive meets all limits");
const said = (each, text) => `${reach(each, text)}: ${best(each)}`;

function line(each, colour, more, why, text) {
  const beyond = !more || !why ? "" : why.status === "fail" ? `beyond it fails: ${why.tight} ${why.said}` : "beyond it another is better";
  const made = element("li", {}, element("i", { className: colour }), element("span", { textContent: reach(each, text) }), element("div", {}, element("span", { textContent: best(each) }), " ", element("small", { textContent: beyond })));
  return Object.assign(made, { from: each.from, to: each.to });
}

/** Marks the stretch in which a value is. */
export function here(list, value) {
  let nearest = null, least = Infinity;
  for (const item of list.children) {
    const off = Math.max(item.from - value, value - item.to, 0);
    if (off < least) [nearest, least] = [item, off];
  }
  for (const item of list.children) item.classList.toggle("here", item === nearest);
}
