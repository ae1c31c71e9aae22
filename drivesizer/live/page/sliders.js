// Sliders: a figure of the spec over a range, with the best drive at each place of it; a map over two of them.

import { button, element, keyOf, words } from "./dom.js";
import { pieces, whenFree, whole } from "./requests.js";
import { changed, state } from "./state.js";

const panel = document.getElementById("sliders");
const STEPS = 300, STILL = 400; // about so many places; ms after which a slider no longer moves
const FIGURE = /^\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(.*)$/;
let act = () => {};

export function prepare(onEdits) { act = onEdits; }

/** The text of the spec at a place, if it is a figure. */
function figureAt(path) {
  const value = path.reduce((at, step) => at?.[step], state.data);
  const found = typeof value === "string" || typeof value === "number" ? FIGURE.exec(String(value)) : null;
  return found ? { number: Number(found[1]), unit: found[2] } : null;
}

/** Opens the slider of a figure and gives it the keyboard, unless it is one of a link; a second time the same. */
export function open(given, keyboard = true) {
  const { path } = given, there = state.sliders.find((one) => keyOf(one.path) === keyOf(path));
  const figure = figureAt(path), bounds = Number.isFinite(given.low) && given.low < given.high ? { low: given.low, high: given.high } : null;
  if (there && bounds) rebound(there, bounds);
  if (there || !figure) return there && shown(there);
  const one = { path, whole: Boolean(given.whole), points: new Map(), rejected: new Map() };
  one.text = (value) => `${Number(value.toPrecision(8))}${one.unit ? ` ${one.unit}` : ""}`;
  Object.assign(one, figure, bounds ?? around(figure.number, one.whole));
  build(one);
  state.sliders.push(one);
  changed();
  want(one);
  return keyboard && shown(one);
}

function shown(one) {
  one.range.focus({ preventScroll: true });
  requestAnimationFrame(() => one.box.scrollIntoView({ block: "nearest", behavior: "instant" }));
}

/** Bounds of a slider at first. */
function around(value, whole) {
  if (whole) return { low: Math.min(1, value), high: Math.max(2 * value, 2) };
  if (value === 0) return { low: 0, high: 10 };
  const near = value / 4, far = 2 * value;
  return value > 0 ? { low: near, high: far } : { low: far, high: 0 };
}

/** A step that one would choose: 1, 2 or 5 of a power of ten. */
function stepOf(one) {
  if (one.whole) return 1;
  const least = (one.high - one.low) / STEPS, power = 10 ** Math.floor(Math.log10(least));
  return power * ([1, 2, 5].find((each) => each * power >= least * 0.8) ?? 10);
}

// -- how it looks

function build(one) {
  const label = one.path.map(words).join(" · ");
  one.range = element("input", { type: "range", min: 0, step: 1, aria: { label } });
  one.value = element("span", { className: "value" });
  one.band = element("div", { className: "band", aria: { hidden: "true" } });
  one.mark = element("b");
  one.list = element("ul", { className: "stretches" });
  one.all = element("summary", { textContent: "best drives over the range" });
  const close = button("×", () => shut(one), { className: "small", title: "close the slider", aria: { label: `close the slider for ${label}` } });
  const top = element("div", { className: "top" }, element("span", { textContent: label }), one.value, close);
  one.ends = ["low", "high"].map((end) => bound(one, end, label));
  one.far = element("span", { className: "far" });
  const free = button("free", () => act([[one.path, { free: one.ends.map((end) => end.value).join(" .. ") }, false]]), { title: "leave the figure free in this range, for the best machine" });
  one.box = element("div", { className: "slider" }, top, one.range, element("div", { className: "banded" }, one.band, one.mark), element("p", { className: "bounds" }, one.ends[0], one.far, free, one.ends[1]), element("details", {}, one.all, one.list));
  one.range.addEventListener("input", () => moved(one));
  panel.append(one.box);
  ranged(one);
}

/** A bound of the range, which may be typed over. */
function bound(one, end, label) {
  const made = element("input", { type: "text", autocomplete: "off", spellcheck: false, aria: { label: `${end === "low" ? "from" : "to"}, slider for ${label}` } });
  made.addEventListener("change", () => {
    const found = FIGURE.exec(made.value), next = { low: one.low, high: one.high, [end]: Number(found?.[1]) };
    if (found && next.low < next.high && (found[2] === "" || found[2] === one.unit)) rebound(one, next);
    else ranged(one);
  });
  return made;
}

function rebound(one, bounds) {
  Object.assign(one, bounds);
  changed();
  want(one);
  ranged(one);
}

/** Sets range and bounds, with places at round figures. */
function ranged(one) {
  one.step = stepOf(one);
  one.first = Math.ceil(one.low / one.step - 1e-9);
  one.range.max = String(Math.floor(one.high / one.step + 1e-9) - one.first);
  for (const [n, value] of [one.low, one.high].entries()) one.ends[n].value = one.text(value);
  follow(one);
}

function shut(one) {
  drop(one);
  one.box.remove();
  state.sliders = state.sliders.filter((other) => other !== one);
  changed();
  const opener = document.querySelector(`#form [data-key="${CSS.escape(keyOf([...one.path, "~"]))}"]`);
  (opener?.checkVisibility() ? opener : panel.querySelector("input") ?? document.getElementById("as-form")).focus({ preventScroll: true });
}

// -- how it moves

const valueOf = (one) => Number(((one.first + Number(one.range.value)) * one.step).toPrecision(8));

function moved(one) {
  const value = valueOf(one), text = one.text(value);
  one.moving = performance.now();
  one.number = value;
  said(one, text);
  act([[one.path, text, false]], keyOf(one.path));
}

function said(one, text) {
  one.range.setAttribute("aria-valuetext", text);
  one.value.textContent = text;
  one.mark.style.left = `${100 * Math.min(Math.max((one.number - one.low) / (one.high - one.low), 0), 1)}%`;
  here(one.list, one.number);
}

/** Sets a slider to what the spec says; where it has no such figure now, it is not shown. */
function follow(one) {
  const figure = figureAt(one.path);
  one.box.hidden = !figure;
  if (!figure || performance.now() - (one.moving ?? -Infinity) < STILL) return undefined;
  if (figure.unit !== one.unit || (figure.number !== one.number && (figure.number < one.low || figure.number > one.high))) {
    Object.assign(one, figure, around(figure.number, one.whole));
    ranged(one);
    return want(one);
  }
  one.number = figure.number;
  one.range.value = String(Math.round(figure.number / one.step) - one.first);
  return said(one, one.text(figure.number));
}

/** The spec has changed: sliders follow, and what hangs on other figures is computed anew. */
export function renew() {
  for (const one of state.sliders) {
    follow(one);
    if (!one.box.hidden) again(one);
  }
}

/** Draws what is known of a slider's range by now. */
function seen(one, left) {
  const count = drawBand(one);
  here(one.list, one.number);
  one.far.textContent = left ? `computing, ${left} left …` : "";
  one.all.textContent = count === 1 ? "one best drive over the range" : `best drives over the range: ${count} stretches`;
}

// -- stretches of a figure over which the same drive is the best: a band of colours, and a line for each

const COLOURS = 6, NAMED = 0.16; // share of a band from which a drive's name has room on it
const known = new Map(); // drives by their names, in the order in which they were met: one drive, one colour

const same = (a, b) => a.status === b.status && (a.label === b.label || a.status === "fail");
const passes = (each) => each.status !== "fail" && each.status !== "wrong";

/** Neighbouring places with the same best drive, of points by their value. */
function stretches(points) {
  const list = [];
  for (const [value, point] of [...points].sort(([a], [b]) => a - b)) {
    const last = list.at(-1);
    if (last && same(last, point)) last.to = value;
    else list.push({ ...point, from: value, to: value });
  }
  return list;
}

/** The class of a drive's colour. */
function colour(each) {
  if (!passes(each)) return each.status === "wrong" ? "wait" : "none";
  if (!known.has(each.label)) known.set(each.label, known.size % COLOURS);
  return `s${known.get(each.label)}`;
}

/** Draws both; `text` writes a value, `rejected` says by the end of a stretch why its drive is not the best beyond it. */
function drawBand({ band, list, low, high, points, rejected, text }) {
  const found = stretches(points);
  band.replaceChildren(...found.map((each, n) => {
    const start = n ? (found[n - 1].to + each.from) / 2 : low, end = n + 1 < found.length ? (each.to + found[n + 1].from) / 2 : each.to;
    const share = (end - start) / (high - low), name = share >= NAMED && passes(each) ? each.name ?? "" : "";
    const piece = element("i", { className: colour(each), title: `${reach(each, text)}: ${best(each)}` }, ...(name ? [element("span", { textContent: name })] : []));
    piece.style.width = `${100 * share}%`;
    return piece;
  }));
  list.replaceChildren(...found.map((each, n) => line(each, colour(each), n + 1 < found.length, rejected.get(each.to), text)));
  return found.length;
}

const reach = (each, text) => (each.from === each.to ? text(each.from) : `${text(each.from)} to ${text(each.to)}`);
const best = (each) => (passes(each) ? each.label : each.status === "wrong" ? each.said : "no drive meets all limits");

function line(each, colour, more, why, text) {
  const beyond = !more || !why ? "" : why.status === "fail" ? `beyond it fails: ${why.tight} ${why.said}` : "beyond it another is better";
  const made = element("li", {}, element("i", { className: colour }), element("span", { textContent: reach(each, text) }), element("div", {}, element("span", { textContent: best(each) }), " ", element("small", { textContent: beyond })));
  return Object.assign(made, { from: each.from, to: each.to });
}

/** Marks the stretch in which a value is. */
function here(list, value) {
  let nearest = null, least = Infinity;
  for (const item of list.children) {
    const off = Math.max(item.from - value, value - item.to, 0);
    if (off < least) [nearest, least] = [item, off];
  }
  for (const item of list.children) item.classList.toggle("here", item === nearest);
}

// -- the best drive at places of a range, one slider after the other, while nothing else is wanted of the engine

const POINTS = 25, FINER = 4, MOST_REASONS = 12, REST = 500; // ms without a change before a range is computed anew
let current = null; // {one, control}
let paused = 0;

/** The text could not be read meanwhile. */
class Unread extends Error {}

/** Computes the range of a slider, as soon as those before it are done. */
function want(one) {
  drop(one);
  one.points.clear();
  one.rejected.clear();
  one.others = rest(one);
  one.wanted = true;
  work();
}

/** Computes it anew where other figures than its own have changed. */
function again(one) {
  const others = rest(one);
  if (one.others === others) return;
  one.others = others;
  clearTimeout(one.wait);
  one.wait = setTimeout(() => want(one), REST);
}

function drop(one) {
  clearTimeout(one.wait);
  one.wanted = false;
  if (current?.one === one) current.control.abort();
}

/** The spec without the figure of a slider. */
function rest(one) {
  const copy = structuredClone(state.data ?? {});
  const place = one.path.slice(0, -1).reduce((at, step) => at?.[step], copy);
  if (place) place[one.path.at(-1)] = null;
  return JSON.stringify(copy);
}

/** One slider after the other; what is stopped for something else stays wanted. */
async function work() {
  const one = state.sliders.find((each) => each.wanted), control = new AbortController();
  if (current || paused || !one) return;
  current = { one, control };
  try {
    await sweep(one, control.signal);
    if (!control.signal.aborted) one.wanted = false;
  } catch (error) {
    if (error.name !== "AbortError") {
      one.wanted = false;
      one.others = null; // at the next text that can be read it is computed anew
      one.far.textContent = `not computed: ${error instanceof Unread ? error.message : "the server does not answer"}`;
    }
  }
  current = null;
  work();
}

function pause() {
  paused += 1;
  current?.control.abort();
}

function goOn() {
  paused -= 1;
  work();
}
whenFree(pause, goOn);

async function sweep(one, signal) {
  const count = one.whole ? Math.min(POINTS, one.high - one.low + 1) : POINTS;
  const values = Array.from({ length: count }, (_, n) => one.low + (n / Math.max(count - 1, 1)) * (one.high - one.low));
  await look(one, values, signal);
  await look(one, between(one), signal);
  await reasons(one, signal);
}

/** The best drive at values, at steps of the slider; what is known is not computed again. */
async function look(one, given, signal) {
  const rounded = (value) => Number((Math.round(value / one.step) * one.step).toPrecision(8));
  const bounded = (value) => Math.min(one.high, Math.max(one.low, rounded(value)));
  const values = [...new Set(given.map(bounded))].filter((value) => !one.points.has(value));
  if (!values.length) return seen(one, 0);
  let left = values.length;
  seen(one, left);
  for await (const piece of pieces("sweep", { text: state.text, path: one.path, values: values.map(one.text) }, signal)) {
    if (piece.kind === "wrong") throw new Unread(piece.lines.join("; "));
    if (piece.kind !== "point") continue;
    one.points.set(values[piece.number], piece);
    left -= 1;
    seen(one, left);
  }
  return undefined;
}

/** Places between two of which the best drive differs. */
function between(one) {
  const points = [...one.points].sort(([a], [b]) => a - b), found = [];
  for (let n = 1; n < points.length; n += 1) {
    const [[from, before], [to, after]] = [points[n - 1], points[n]];
    if (!same(before, after)) for (let k = 1; k <= FINER; k += 1) found.push(from + (k * (to - from)) / (FINER + 1));
  }
  return found;
}

/** Why the best drive of a stretch is not that of the next; of a machine it is not known. */
async function reasons(one, signal) {
  const list = stretches(one.points);
  for (let n = 0; n + 1 < list.length && n < MOST_REASONS; n += 1) {
    if (signal.aborted) throw new DOMException("", "AbortError");
    const { to, parts } = list[n];
    if (!passes(list[n]) || !parts?.length || Array.isArray(parts[0]) || one.rejected.has(to)) continue;
    const edits = [[one.path, one.text(list[n + 1].from), false]];
    const [found] = await whole("rejected", { text: state.text, edits, motor: parts[0], gearhead: parts[1] }, signal).catch((error) => { if (error.name === "AbortError") throw error; return []; });
    if (found?.kind === "rejected") one.rejected.set(to, found);
    seen(one, 0);
  }
}

// -- the best drive over the figures of two sliders, computed where the user wants it

const CELLS = 7; // along each side
const mapButton = button("map over both sliders", drawMap, { hidden: true }), map = element("div", { className: "map", hidden: true });
let mapping = null; // the map that is being computed
panel.append(mapButton, map);
whenFree(() => mapping?.abort(), () => {});

/** The button is there while two sliders are; a map of another spec goes. */
export function renewMap() {
  const open = state.sliders.filter((one) => !one.box.hidden);
  mapButton.hidden = open.length !== 2;
  panel.append(mapButton, map);
  if (map.of !== JSON.stringify([open.map(({ path, low, high }) => [path, low, high]), state.text])) map.hidden = true;
}

const values = (one) => Array.from({ length: CELLS }, (_, n) => {
  const value = one.low + (n / (CELLS - 1)) * (one.high - one.low);
  return one.text(one.whole ? Math.round(value) : Number(value.toPrecision(4)));
});

async function drawMap() {
  const [across, up] = state.sliders.filter((one) => !one.box.hidden), text = state.text;
  mapping?.abort();
  mapping = new AbortController();
  const [columns, rows] = [values(across), values(up).reverse()];
  map.of = JSON.stringify([[across, up].map(({ path, low, high }) => [path, low, high]), text]);
  const cells = rows.map(() => columns.map(() => element("i", { className: "wait" }))), legend = element("ul", { className: "legend" });
  const named = (one, all) => element("p", { className: "ends", textContent: `${one.path.map(words).join(" · ")}: ${all[0]} to ${all.at(-1)}` });
  map.replaceChildren(named(up, [...rows].reverse()), element("div", { className: "cells" }, ...cells.flat()), named(across, columns), legend);
  map.hidden = false;
  pause(); // a tab's sweeps take the place of one another
  try {
    for (const [n, row] of rows.entries()) {
      for await (const piece of pieces("sweep", { text, edits: [[up.path, row, false]], path: across.path, values: columns }, mapping.signal)) {
        if (piece.kind === "point") fill(cells[n][piece.number], piece, `${columns[piece.number]}, ${row}`, legend);
      }
    }
  } catch (error) {
    if (error.name !== "AbortError") legend.append(element("li", { textContent: "not computed: the server does not answer" }));
  } finally {
    goOn();
  }
}

function fill(cell, point, where, legend) {
  cell.className = colour(point);
  cell.title = `${where}: ${best(point)}`;
  if ([...legend.children].some((one) => one.dataset.label === point.label)) return;
  const name = passes(point) ? point.name ?? point.label : "none";
  legend.append(element("li", { dataset: { label: point.label } }, element("i", { className: colour(point) }), ` ${name}`));
}
