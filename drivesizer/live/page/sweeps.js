// The best drive at places of a range, one slider after the other, while nothing else is wanted of the engine.

import { pieces, whole, whenFree } from "./requests.js";
import { state } from "./state.js";
import { passes, same, stretches } from "./stretches.js";

const POINTS = 25, FINER = 4, MOST_REASONS = 12, REST = 500; // ms without a change before a range is computed anew
const queue = [];
let current = null; // {one, control}
let paused = 0;
let seen = () => {};

export function watch(watcher) { seen = watcher; }

/** The text could not be read meanwhile. */
class Unread extends Error {}

/** Computes the range of a slider. */
export function want(one) {
  one.points.clear();
  one.rejected.clear();
  one.others = rest(one);
  enqueue(one);
}

/** Computes it anew where other figures than its own have changed. */
export function renew(one) {
  const others = rest(one);
  if (one.others === others) return;
  one.others = others;
  clearTimeout(one.wait);
  one.wait = setTimeout(() => want(one), REST);
}

export function drop(one) {
  clearTimeout(one.wait);
  if (queue.includes(one)) queue.splice(queue.indexOf(one), 1);
  if (current?.one === one) current.control.abort();
}

function enqueue(one) {
  drop(one);
  queue.push(one);
  work();
}

/** The spec without the figure of a slider. */
function rest(one) {
  const copy = structuredClone(state.data ?? {});
  const place = one.path.slice(0, -1).reduce((at, step) => at?.[step], copy);
  if (place) place[one.path.at(-1)] = null;
  return JSON.stringify(copy);
}

async function work() {
  if (current || paused || !queue.length) return;
  const mine = { one: queue.shift(), control: new AbortController() };
  current = mine;
  try {
    await sweep(mine.one, mine.control.signal);
  } catch (error) {
    if (error instanceof Unread) {
      mine.one.others = null; // at the next text that can be read it is computed anew
      mine.one.far.textContent = `not computed: ${error.message}`;
    } else if (error.name !== "AbortError") mine.one.far.textContent = "not computed: the server does not answer";
    else if (paused) queue.unshift(mine.one);
  }
  current = null;
  work();
}

export function pause() {
  paused += 1;
  current?.control.abort();
}

export function goOn() {
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
