// The best drive in a few figures, always in sight, or what is wrong with the spec; below it the answer in one look.

import { button, choice, element } from "./dom.js";
import { written } from "./fields.js";
import { whole } from "./requests.js";
import { state } from "./state.js";

const headline = document.getElementById("headline");
const voice = document.getElementById("said");
const QUIET = 900, SLOW = 500; // ms without another answer, after which it is said aloud, or the one before is greyed
let speaking = 0, greying = 0;
let edit = { of: null, before: {}, now: {} }; // figures before the last edit, and since

export function busy() {
  document.documentElement.dataset.state = "busy";
  clearTimeout(greying);
  greying = setTimeout(() => headline.classList.add("stale"), SLOW);
}

/** Forgets the figures before: another spec follows. */
export function forget() {
  edit = { of: null, before: {}, now: {} };
  unchosen();
}

/** Says a new best drive once, and not at every place of a slider. */
function say(text) {
  clearTimeout(speaking);
  speaking = setTimeout(() => { if (voice.textContent !== text) voice.textContent = text; }, QUIET);
}

function put(kind, ...inside) {
  clearTimeout(greying);
  headline.className = kind;
  headline.replaceChildren(...inside);
}

/** What to buy, and what decides; with its closed loop the whole answer is there. `by` is the edit that it answers. */
export function rank(piece, state = "ranked", by = edit.of) {
  document.documentElement.dataset.state = state;
  beside(piece);
  const best = piece.machine ? piece : piece.sets[0];
  const now = best ? { mass: best.mass, price: best.price, margin: best.tight?.margin } : {};
  edit = by === edit.of ? { ...edit, now } : { of: by, before: edit.now, now };
  if (piece.machine) return machine(piece);
  const none = "No drive meets all limits.";
  if (!best) {
    put("fail", head("fail", none), facts([["drives considered", count(piece.considered)]]));
    return say(none);
  }
  const shown = [...piece.loops];
  if (best.figures.energy) shown.push(["energy per cycle", best.figures.energy]);
  shown.push([`of ${count(piece.considered)}, by ${piece.objective.replaceAll("_", " ")}`, piece.met]);
  const text = piece.found ? best.name : `${none} The closest: ${best.name}`;
  put(piece.status, element("div", {}, head(piece.status, text, best.numbers), facts(shown)), tiles(best, "a drive"));
  return say(`${piece.status}: ${piece.found ? "" : `${none} The closest: `}${best.label}`);
}

const count = (value) => value.toLocaleString("en");

function head(status, text, numbers = "") {
  const made = element("p", { className: "best" }, element("span", { className: `pill ${status}`, textContent: status }), ` ${text}`);
  if (numbers) made.append(" ", element("small", { textContent: numbers }));
  return made;
}

function facts(pairs) {
  return element("dl", {}, ...pairs.map(([title, value]) => element("div", {}, element("dt", { textContent: title }), element("dd", { textContent: value }))));
}

// -- three tiles: mass, price and the smallest margin, with what the last edit changed

const grams = (value) => (Math.abs(value) < 1 ? `${Number((value * 1e3).toPrecision(3))} g` : `${Number(value.toPrecision(3))} kg`);
const TILES = [
  ["mass", (of) => `mass of ${of}`, grams],
  ["price", (of) => `price of ${of}`, (value) => value.toFixed(2)],
  ["margin", () => "", (value) => `${Number((100 * value).toPrecision(2))} %`],
];

function tiles(best, of) {
  return element("div", { className: "key-figures" }, ...TILES.map(([name, title, written]) => {
    if (name !== "margin") return tile(title(of), best.figures[name], change(name, written));
    if (!best.tight) return "";
    const { axis, title: check, said, margin, status } = best.tight;
    return tile(`margin: ${axis ? `${axis}, ` : ""}${check}`, said, change(name, written), bar(margin, status));
  }));
}

function tile(title, said, ...more) {
  return element("div", { className: "key-figure" }, element("span", { textContent: title, title }), element("strong", { textContent: said }), ...more);
}

/** What a figure has changed by since the edit before. */
function change(name, written) {
  const by = edit.now[name] - edit.before[name];
  if (!Number.isFinite(by) || written(Math.abs(by)).startsWith("0 ") || written(Math.abs(by)) === "0.00") return "";
  const more = by > 0;
  return element("span", { className: "change", title: "since the last edit" }, `${more ? "+" : "−"}${written(Math.abs(by))} ${more ? "▲" : "▼"}`);
}

/** The share of a limit that is used, as the report draws it: the limit at 80 %. */
function bar(margin, status) {
  const made = element("span", { className: `bar ${status}`, aria: { hidden: "true" } }, element("i"), element("b"));
  made.firstChild.style.width = `${80 * Math.min(Math.max(1 / (1 + margin), 0), 1.25)}%`;
  return made;
}

const MOST = 6; // axes with their drives

/** The axes of a machine with their drives, first those without one. */
function machine(piece) {
  const without = piece.axes.filter((one) => !one.label), others = piece.axes.filter((one) => one.label);
  const text = `Machine of ${piece.axes.length} axes${without.length ? `, ${without.length} without a drive that meets all limits` : ""}`;
  const shown = [...without, ...others].slice(0, MOST).map((one) => [one.axis, one.name ?? "no drive"]);
  if (piece.axes.length > MOST) shown.push(["and", `${piece.axes.length - MOST} more`]);
  shown.push(...piece.loops.filter(([, said]) => said !== "pass").map(([axis, said]) => [`${axis} in closed loop`, said]));
  put(`${piece.status} several`, element("div", {}, head(piece.status, text), facts(shown)), tiles(piece, "all drives"));
  say(`${piece.status}: ${text}`);
}

/** Free figures are no drive yet: `find` looks for the best machine. */
export function free(figures, find) {
  document.documentElement.dataset.state = "free";
  glance.hidden = true;
  const text = figures.length === 1 ? "One figure is free" : `${figures.length} figures are free`;
  put("free", element("div", {}, element("p", { className: "best", textContent: text }), facts(figures.map(([name, given]) => [name, written(given)]))), button("Find the best machine", find));
  say(text);
}

/** What is wrong, as the command line prints it, each with a button that shows the place. */
export function wrong(faults, reveal) {
  document.documentElement.dataset.state = "wrong";
  const lines = faults.map((fault) => {
    const line = element("p", { className: "fault" }, fault.said);
    if (fault.line || fault.path.length) line.append(" ", button("show", () => reveal(fault), { aria: { label: `show the place: ${fault.said}` } }));
    return line;
  });
  put("wrong", element("p", { className: "best", textContent: faults.length === 1 ? "The spec has a fault" : `The spec has ${faults.length} faults` }), ...lines);
  say(faults.map((fault) => fault.said).join("; "));
}

// -- the answer in one look: the next best drives, the smallest margins and the torque-speed field, above the report

const glance = document.getElementById("glance"), jump = document.getElementById("jump");
const [margins, others] = glance.querySelectorAll(".list");
const OTHERS = 5;
const ROW = [["summary", "Summary"], ["checks", "Checks"], ["over-time", "Cycle"], ["heat", "Heat"], ["energy", "Energy"], ["loop", "Loop"], ["closed_loop", "Loop"], ["candidates", "Candidates"], ["datasheets", "Data"]];

/** The next best, each with a box by which it is compared, and the checks that decide. */
function beside(piece) {
  glance.hidden = piece.machine || !piece.sets.length;
  if (glance.hidden) return;
  const next = piece.sets.slice(1, 1 + OTHERS);
  others.parentElement.hidden = !next.length;
  others.replaceChildren(...next.map(line));
  margins.replaceChildren(...piece.margins.map((one) => element("li", {}, element("span", { textContent: one.title }), element("span", { className: "figure", textContent: one.said }), bar(one.margin, one.status))));
}

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

// -- two or more drives side by side

const panel = document.getElementById("compared");
const chosen = choice(4, (one) => `${one.motor} ${one.gearhead}`, () => compared(true));
const tick = (one) => chosen.box(one, `compare ${one.label}`);

/** Gives every drive of the table a box by which it is chosen; a machine's drives have none, and no comparison. */
export function boxes(drives) {
  if (!drives.length) unchosen();
  for (const row of document.querySelectorAll("#sets tr[data-rank]")) {
    const one = drives.find((each) => String(each.rank) === row.dataset.rank);
    if (one && !row.cells[0].querySelector("input")) row.cells[0].prepend(tick(one));
  }
}

function unchosen() {
  panel.replaceChildren();
  return chosen.clear();
}

/** The comparison for the spec as it is now; shown where it has just been chosen. */
export async function compared(now = false) {
  const drives = chosen.list();
  if (drives.length < 2) {
    panel.replaceChildren(...(now && drives.length ? [element("p", { className: "note", textContent: "Choose a second drive to see both side by side." })] : []));
    return;
  }
  const text = state.text;
  try {
    const [found] = await whole("compare", { text, sets: drives.map((one) => [one.motor, one.gearhead]) });
    if (found?.kind === "compared" && text === state.text) panel.replaceChildren(...sideBySide(found));
  } catch (error) {
    panel.replaceChildren(element("p", { className: "fault", textContent: `not compared: ${error.message}` }));
  }
}

function sideBySide(found) {
  const close = button("close", () => unchosen()?.focus());
  const table = element("div", { innerHTML: found.html }); // of the server's own templates, which escape every text
  const section = element("section", {}, element("div", { className: "head" }, element("h2", { textContent: "Side by side" }), close), table);
  tabled(section);
  return [section];
}
