// The page: what the user changes goes to the engine, and what it finds is shown.

import * as answer from "./answer.js";
import * as catalogue from "./catalogue.js";
import { able, button, element, enable } from "./dom.js";
import * as files from "./files.js";
import * as form from "./form.js";
import * as headline from "./headline.js";
import { get, pieces } from "./requests.js";
import * as sliders from "./sliders.js";
import { packed, put, redo, state, undo, unpacked, watch } from "./state.js";

const LONGEST_WAIT = 600; // ms, after which a newer request stops one that has not answered
const TYPING = 350; // ms without a key, after which a text is read
const area = document.getElementById("text"), more = document.getElementById("more"), loop = document.getElementById("loop");
const designed = document.getElementById("designed"); // the best machine of free figures
const page = document.documentElement.dataset; // its state, and how often it has ranked and answered
let running = null; // the request under way
let pending = null; // edits that wait for it

// -- changes

/** Makes edits of fields; places of one slider follow one another, other edits are all made. */
function edit(edits, what = "") {
  const before = pending && (what && what === pending.what ? [] : pending.edits);
  if (edits.length) pending = { edits: [...(before ?? []), ...edits], what };
  if (edits.length) next();
  else show();
}

/** Sends what waits, as soon as the ranking that is under way has come; one that is slow is stopped. */
function next() {
  clearTimeout(running?.stop);
  if (!running || running.ranked) send();
  else running.stop = setTimeout(send, LONGEST_WAIT - (performance.now() - running.since));
}

/** Reads another text in place of the spec, whatever waits. */
function restart(text) {
  form.forget();
  headline.forget();
  replace(text);
}

function replace(text, what = "") {
  put(text, what);
  area.value = text;
  pending = null;
  if (running) running.read = true; // its edits were of another text
  send();
}

async function send() {
  running?.control.abort();
  clearTimeout(running?.stop);
  const unread = running && !running.read ? running.edits : []; // stopped before they were in the text
  const mine = { control: new AbortController(), since: performance.now(), ranked: false, read: false, what: pending?.what ?? "", edits: [...unread, ...(pending?.edits ?? [])] };
  running = mine;
  pending = null;
  headline.busy();
  try {
    for await (const piece of pieces("answer", { text: state.text, edits: mine.edits }, mine.control.signal)) {
      if (running !== mine) return;
      take(piece, mine);
    }
    files.reachable(true);
    if (running === mine && !pending && page.state === "ranked") page.state = "whole";
  } catch (error) {
    if (error.name === "AbortError") return;
    if (running === mine && !mine.read) pending = { edits: [...mine.edits, ...(pending?.edits ?? [])], what: "" };
    if (running === mine) files.reachable(false); // what was to be changed waits for it
  } finally {
    if (running === mine) ended(mine);
  }
}

/** The request is over: its number is that of the texts that were answered. */
function ended(mine) {
  page.answers = String(Number(page.answers ?? 0) + 1);
  mine.ranked = true;
  mine.read = true;
  if (pending && !files.gone()) send();
}

function take(piece, mine) {
  if (piece.kind === "spec") {
    state.data = piece.data;
    state.faults = [];
    mine.yaml = true;
    form.use(true);
    read(piece.text, mine);
  } else if (piece.kind === "wrong") {
    state.faults = piece.faults ?? piece.lines.map((text) => ({ said: text, text, line: null, path: [] }));
    mine.ranked = true;
    const text = piece.text ?? state.text, empty = !/^\s*[^#\s]/m.test(text);
    if (!mine.yaml && !mine.edits.length) { // a text that is no YAML is put right as such; the form can fill an empty one
      if (empty) state.data = {};
      form.use(empty);
    }
    answer.stale();
    headline.wrong(state.faults, reveal);
    read(text, mine);
  } else if (piece.kind === "ranking") {
    page.ranked = String(Number(page.ranked ?? 0) + 1);
    mine.ranked = true;
    designed.replaceChildren();
    headline.rank(piece, "ranked", mine.what || mine);
    sliders.renew();
    more.hidden = false;
    if (pending) send();
  } else if (piece.kind === "free") {
    mine.ranked = true;
    answer.sections([]);
    headline.row([]);
    headline.boxes([]);
    sliders.renew();
    headline.free(piece.figures, (event) => awaited("design", event.currentTarget, "searching …", best));
    more.hidden = true;
  } else found(piece);
}

function read(text, mine) {
  put(text, mine.what);
  mine.read = true;
  show();
}

/** Pieces of a report, of an answer or of a closed loop. */
function found(piece) {
  if (piece.kind === "ranking") headline.rank(piece, "whole");
  else if (piece.kind === "sections") {
    answer.sections(piece.sections);
    headline.row(piece.sections);
    headline.boxes(piece.drives ?? []);
    headline.compared();
  } else if (piece.kind === "figures") answer.plots(piece.figures);
  else if (piece.kind === "still") answer.still(piece.name, piece.address);
}

function show() {
  form.show(state.data, state.faults);
  if (document.activeElement !== area) area.value = state.text;
}

// -- what is typed as YAML

let typing = 0;
function typed() {
  clearTimeout(typing);
  typing = 0;
  if (area.value !== state.text) replace(area.value, "yaml");
}
area.addEventListener("input", () => {
  clearTimeout(typing);
  typing = setTimeout(typed, TYPING);
});
area.addEventListener("blur", () => { if (typing) typed(); });

/** Waits until all that is typed is in the text of the spec. */
async function settled() {
  if (typing) typed();
  if (document.activeElement?.closest("#form")) document.activeElement.dispatchEvent(new Event("change"));
  while (!files.gone() && (pending || (running && !running.read))) await new Promise((done) => { setTimeout(done, 20); });
}

/** What is typed in the form and not in the text, as the server does not answer: a comment each. */
function unmade() {
  return (pending?.edits ?? []).map(([path, value]) => `# typed since: ${path.join(".")}: ${JSON.stringify(value)}\n`);
}

// -- what the user waits for: the closed loop, and the best machine of free figures

/** Shows what a job finds of the text as it is now; its button says meanwhile that it runs. */
async function awaited(job, made, busy, show) {
  if (!able(made)) return;
  const words = made.textContent;
  enable(made, false);
  files.withdraw(job);
  made.textContent = busy;
  await settled();
  const text = state.text;
  try {
    for await (const piece of pieces(job, { text })) {
      if (text !== state.text) break;
      if (piece.kind === "wrong") files.notice(piece.lines.join("; "), [], "", job);
      else show(piece);
    }
  } catch {
    files.reachable(false);
  }
  enable(made, true);
  made.textContent = words;
  const head = document.querySelector(job === "loop" ? '[data-name="loop"] > *, [data-name="closed_loop"] > *' : "#designed > *");
  if (text !== state.text) files.notice("The spec was changed in the meantime: what was found is not shown.", [], "said");
  else head?.focus({ preventScroll: true });
  head?.scrollIntoView();
}
loop.addEventListener("click", () => awaited("loop", loop, "simulating …", found));

/** The best machine, and buttons that fill its figures in. */
function best(piece) {
  if (piece.kind !== "designed") return;
  designed.replaceChildren(element("h2", { tabIndex: -1, textContent: "The best machine" }), element("div", { innerHTML: piece.html }), // of the server's own templates, which escape every text
    element("p", {}, ...piece.fills.map(([name, filled]) => button(`Use the ${name} figures`, () => restart(filled)))));
  tabled(designed);
  turn("answer");
}

// -- which part is in sight, which the stylesheet decides: form or YAML, and on a narrow screen machine or answer

/** On a narrow screen: `machine` or `answer`. */
function turn(name) {
  document.getElementById(`pane-${name}`).checked = true;
  dispatchEvent(new Event("resize")); // for figures that were drawn for another width
}

/** Shows the field of a fault, or its line. */
function reveal(fault) {
  turn("machine");
  const fields = document.getElementById("form");
  if (fields.checkVisibility() && !fields.inert && form.focus(fault.path)) return;
  document.getElementById("as-yaml").checked = true;
  const lines = area.value.split("\n"), number = Math.min(fault.line ?? 1, lines.length);
  const start = lines.slice(0, number - 1).reduce((sum, line) => sum + line.length + 1, 0);
  area.focus();
  area.setSelectionRange(start, start + lines[number - 1].length);
  area.scrollTop = Math.max(0, (number - 4) * parseFloat(getComputedStyle(area).lineHeight));
}

document.getElementById("as-yaml").addEventListener("change", () => { if (state.faults[0]?.line) reveal(state.faults[0]); });
document.getElementById("switch").addEventListener("change", (event) => {
  turn(event.target.id.slice(5));
  scrollTo({ top: front.offsetTop });
});
document.querySelector(".skip").addEventListener("click", () => turn("answer"));

/** Height of what stays at the top, so that nothing that is scrolled to lies below it. */
const head = document.getElementById("top"), front = document.getElementById("front");
new ResizeObserver(() => {
  const narrow = getComputedStyle(head).display === "contents", stays = narrow ? front : head;
  const height = getComputedStyle(stays).position === "sticky" ? stays.offsetHeight : 0;
  document.documentElement.style.setProperty("--top", `${height}px`);
}).observe(front);

// -- from the start

let keeping = 0;
watch(() => {
  sliders.renewMap();
  enable(document.getElementById("undo"), state.past.length);
  enable(document.getElementById("redo"), state.future.length);
  document.getElementById("unsaved").hidden = state.text === state.saved && state.mark !== null;
  document.title = `${state.text === state.saved ? "" : "• "}${state.name} – drivesizer`;
  clearTimeout(keeping);
  keeping = setTimeout(async () => history.replaceState(null, "", `#${await packed()}`), 300);
});

for (const [name, step] of [["undo", undo], ["redo", redo]]) {
  document.getElementById(name).addEventListener("click", async (event) => {
    if (!able(event.currentTarget)) return;
    await settled();
    step();
    replace(state.text);
  });
}

async function start() {
  form.prepare(await get("schema.json"), edit, sliders.open);
  sliders.prepare(edit);
  catalogue.prepare({ edit, again: () => send(), notice: files.notice });
  files.prepare({ restart, again: () => send(), settled, unmade, turn });
  const file = await get("spec");
  Object.assign(state, { text: file.text, saved: file.text, mark: file.mark, name: file.name });
  document.getElementById("file").textContent = file.name;
  if (file.wrong) files.notice(`${file.name}: cannot be read (${file.wrong}); the page starts with another spec`);
  const opened = await kept(file);
  area.value = state.text;
  if (file.data && state.text === file.text) {
    state.data = file.data;
    show(); // before the engine is ready
  }
  await send();
  for (const one of opened) if (Array.isArray(one?.path)) sliders.open(one, false);
}

/** What the address holds: text and sliders; the file may be another by now. */
async function kept(file) {
  if (location.hash.length < 2) return [];
  try {
    const found = await unpacked(location.hash.slice(1));
    state.text = found.text;
    if (found.mark !== undefined && found.mark !== file.mark && found.text !== file.text) {
      state.mark = found.mark;
      files.differs();
    }
    return found.sliders;
  } catch {
    files.notice("the link was damaged: the file is shown");
    return [];
  }
}

start().catch(() => files.reachable(false));
