// Sliders: a figure of the spec over a range, with the best drive at each place of it.

import { pieces, whole } from "./requests.js";
import { changed, state } from "./state.js";

const panel = document.getElementById("sliders");
const POINTS = 25, FINER = 4, COLOURS = 6, STEPS = 400;
const FIGURE = /^\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(.*)$/;
let act = () => {};

export function prepare(onEdits) { act = onEdits; }

const keyOf = (path) => path.join("\u001f");
const named = (path) => path.map((step) => (typeof step === "number" ? `${step + 1}` : step.replaceAll("_", " "))).join(" · ");

function element(tag, properties = {}, ...children) {
  const made = Object.assign(document.createElement(tag), properties);
  made.append(...children);
  return made;
}

/** A number of four digits, as one would type it. */
const written = (value) => String(Number(value.toPrecision(4)));

/** The text of the spec at a place, if it is a figure. */
function figureAt(path) {
  const value = path.reduce((at, step) => at?.[step], state.data);
  const found = typeof value === "string" || typeof value === "number" ? FIGURE.exec(String(value)) : null;
  return found ? { number: Number(found[1]), unit: found[2].replace(/\s*[±].*$/, "") } : null;
}

/** Opens the slider of a figure; a second time it gets the keyboard. */
export function open(path) {
  const there = state.sliders.find((one) => keyOf(one.path) === keyOf(path));
  const figure = figureAt(path);
  if (there || !figure) {
    there?.range.focus();
    return;
  }
  const whole = Number.isInteger(figure.number) && !figure.unit;
  const reach = Math.abs(figure.number) || 10;
  const low = figure.number >= 0 ? (whole ? 1 : reach === figure.number ? reach / 4 : 0) : -2 * reach;
  const high = figure.number > 0 ? 2 * reach : figure.number < 0 ? 0 : reach;
  const one = { path, unit: figure.unit, whole, low, high: whole ? Math.max(high, low + 1) : high, points: new Map(), fell: new Map(), control: null };
  build(one);
  state.sliders.push(one);
  changed();
  sweep(one);
}

function build(one) {
  const label = named(one.path);
  one.range = element("input", { type: "range", min: 0, max: one.whole ? one.high - one.low : STEPS, step: 1 });
  one.range.setAttribute("aria-label", label);
  one.output = element("output");
  one.band = element("div", { className: "band", ariaHidden: "true" });
  one.list = element("ul", { className: "stretches" });
  const close = element("button", { type: "button", textContent: "×", title: "close the slider" });
  close.setAttribute("aria-label", `close the slider for ${label}`);
  close.addEventListener("click", () => {
    one.control?.abort();
    one.box.remove();
    state.sliders = state.sliders.filter((other) => other !== one);
    changed();
  });
  one.bounds = element("p", { className: "bounds" }, element("span", { textContent: text(one, one.low) }), element("span", { textContent: text(one, one.high) }));
  one.box = element("div", { className: "slider" }, element("div", { className: "top" }, element("span", { textContent: label }), one.output, close), one.range, one.band, one.bounds, one.list);
  one.range.addEventListener("input", () => {
    const value = text(one, valueOf(one));
    one.range.setAttribute("aria-valuetext", value);
    one.output.textContent = value;
    here(one);
    act([[one.path, value, false]], keyOf(one.path));
  });
  panel.append(one.box);
  follow(one);
}

function valueOf(one) {
  const share = Number(one.range.value) / Number(one.range.max);
  return one.low + share * (one.high - one.low);
}

const text = (one, value) => `${one.whole ? Math.round(value) : written(value)}${one.unit ? ` ${one.unit}` : ""}`;

/** Sets a slider to what the spec says. */
function follow(one) {
  const figure = figureAt(one.path);
  if (!figure) return;
  const share = (figure.number - one.low) / (one.high - one.low);
  if (document.activeElement !== one.range) one.range.value = String(Math.round(share * Number(one.range.max)));
  one.output.textContent = `${written(figure.number)}${figure.unit ? ` ${figure.unit}` : ""}`;
  one.range.setAttribute("aria-valuetext", one.output.textContent);
  here(one);
}

/** The spec has changed: sliders follow, and what hangs on other figures is computed anew. */
export function renew() {
  for (const one of state.sliders) {
    follow(one);
    const others = rest(one);
    if (one.others === others) continue;
    one.others = others;
    clearTimeout(one.wait);
    one.wait = setTimeout(() => sweep(one), 500);
  }
}

/** The spec without the figure of a slider. */
function rest(one) {
  const copy = structuredClone(state.data ?? {});
  const place = one.path.slice(0, -1).reduce((at, step) => at?.[step], copy);
  if (place) place[one.path.at(-1)] = null;
  return JSON.stringify(copy);
}

// -- the best drive at each place

async function sweep(one) {
  one.control?.abort();
  const control = one.control = new AbortController();
  one.others = rest(one);
  one.points.clear();
  one.fell.clear();
  const count = one.whole ? Math.min(POINTS, one.high - one.low + 1) : POINTS;
  const values = Array.from({ length: count }, (_, n) => one.low + (n / Math.max(count - 1, 1)) * (one.high - one.low));
  try {
    await look(one, values, control.signal);
    if (!one.whole) await look(one, between(one), control.signal);
    await reasons(one, control.signal);
  } catch (error) {
    if (error.name !== "AbortError") one.list.replaceChildren(element("li", { textContent: "not computed: the server does not answer" }));
  }
}

async function look(one, values, signal) {
  if (!values.length) return;
  const body = { text: state.text, path: one.path, values: values.map((value) => text(one, value)) };
  for await (const piece of pieces("sweep", { ...body, slider: keyOf(one.path) }, signal)) {
    if (piece.kind !== "point") continue;
    one.points.set(values[piece.number], piece);
    draw(one);
  }
}

const same = (a, b) => a.status === b.status && a.label === b.label;

function ordered(one) {
  return [...one.points].sort(([a], [b]) => a - b).map(([value, point]) => ({ ...point, value }));
}

/** Places between two of which the best drive differs. */
function between(one) {
  const points = ordered(one), found = [];
  for (let n = 1; n < points.length; n += 1) {
    if (same(points[n - 1], points[n])) continue;
    const step = (points[n].value - points[n - 1].value) / (FINER + 1);
    for (let k = 1; k <= FINER; k += 1) found.push(points[n - 1].value + k * step);
  }
  return found;
}

/** Why the best drive of a stretch is not that of the next. */
async function reasons(one, signal) {
  const list = stretches(one);
  for (let n = 0; n + 1 < list.length && n < 12; n += 1) {
    if (signal.aborted) return;
    const before = list[n], parts = before.parts;
    if (before.status === "wrong" || !parts?.length || Array.isArray(parts[0])) continue;
    const edits = [[one.path, text(one, list[n + 1].from), false]];
    const [found] = await whole("rejected", { text: state.text, edits, motor: parts[0], gearhead: parts[1] }).catch(() => []);
    if (found) one.fell.set(before.to, found);
    draw(one);
  }
}

/** Neighbouring places with the same best drive. */
function stretches(one) {
  const list = [];
  for (const point of ordered(one)) {
    const last = list.at(-1);
    if (last && same(last, point)) last.to = point.value;
    else list.push({ ...point, from: point.value, to: point.value });
  }
  return list;
}

function draw(one) {
  const list = stretches(one), span = one.high - one.low, names = [...new Set(list.filter(passes).map((each) => each.label))];
  const colour = (each) => (passes(each) ? `s${names.indexOf(each.label) % COLOURS}` : each.status === "wrong" ? "wait" : "none");
  one.band.replaceChildren(...list.map((each, n) => {
    const start = n ? (list[n - 1].to + each.from) / 2 : one.low, end = n + 1 < list.length ? (each.to + list[n + 1].from) / 2 : each.to;
    const piece = element("i", { className: colour(each) });
    piece.style.width = `${(100 * (end - start)) / span}%`;
    return piece;
  }));
  one.list.replaceChildren(...list.map((each, n) => line(one, each, colour(each), list[n + 1])));
  here(one);
}

const passes = (each) => each.status !== "fail" && each.status !== "wrong";

function line(one, each, colour, next) {
  const fell = one.fell.get(each.to);
  const reach = each.from === each.to ? text(one, each.from) : `${text(one, each.from)} to ${text(one, each.to)}`;
  const best = passes(each) ? each.label : each.status === "wrong" ? each.said : "no drive meets all limits";
  const why = !next || !fell ? "" : fell.status === "fail" ? `; beyond it ${fell.tight} ${fell.said}` : "; beyond it another is better";
  const made = element("li", {}, element("i", { className: colour }), element("span", { textContent: `${reach}: ${best}${why}` }));
  made.from = each.from;
  made.to = each.to;
  return made;
}

/** Marks the stretch in which the slider stands. */
function here(one) {
  const value = valueOf(one);
  let nearest = null, least = Infinity;
  for (const item of one.list.children) {
    const off = Math.max(item.from - value, value - item.to, 0);
    if (off < least) [nearest, least] = [item, off];
  }
  for (const item of one.list.children) item.classList.toggle("here", item === nearest);
}
