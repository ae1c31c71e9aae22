// Sliders: a figure of the spec over a range, with the best drive at each place of it.

import { button, element, keyOf, words } from "./dom.js";
import { changed, state } from "./state.js";
import { draw, here } from "./stretches.js";
import * as sweeps from "./sweeps.js";

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
  sweeps.want(one);
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
  sweeps.want(one);
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
  sweeps.drop(one);
  one.box.remove();
  state.sliders = state.sliders.filter((other) => other !== one);
  changed();
  const opener = document.querySelector(`#form [data-key="${CSS.escape(keyOf([...one.path, "~"]))}"]`);
  (opener?.checkVisibility() ? opener : panel.querySelector("input") ?? document.getElementById("tab-form")).focus({ preventScroll: true });
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
  if (!figure || performance.now() - (one.moving ?? -Infinity) < STILL) return;
  if (figure.unit !== one.unit) {
    one.text = (value) => `${Number(value.toPrecision(8))}${one.unit ? ` ${one.unit}` : ""}`;
  Object.assign(one, figure, around(figure.number, one.whole));
    ranged(one);
    return;
  }
  one.number = figure.number;
  one.range.value = String(Math.round(figure.number / one.step) - one.first);
  said(one, one.text(figure.number));
}

/** The spec has changed: sliders follow, and what hangs on other figures is computed anew. */
export function renew() {
  for (const one of state.sliders) {
    follow(one);
    if (!one.box.hidden) sweeps.renew(one);
  }
}

/** Draws what is known of a slider's range by now. */
sweeps.watch((one, left) => {
  const count = draw(one);
  here(one.list, one.number);
  one.far.textContent = left ? `computing, ${left} left …` : "";
  one.all.textContent = count === 1 ? "one best drive over the range" : `best drives over the range: ${count} stretches`;
});
