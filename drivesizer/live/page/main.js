// The page: what the user changes goes to the engine, and what it finds is shown.

import * as answer from "./answer.js";
import * as catalogue from "./catalogue.js";
import { get, pieces } from "./requests.js";
import * as compare from "./compare.js";
import * as files from "./files.js";
import * as form from "./form.js";
import * as sliders from "./sliders.js";
import { packed, put, redo, state, undo, unpacked, watch } from "./state.js";

const LONGEST_WAIT = 600; // ms, after which a newer request stops one that has not answered
const area = document.getElementById("text");
let running = null; // the request under way
let pending = null; // edits that wait for it

// -- changes

/** Makes edits of fields; the newest answer is that of the newest text. */
function edit(edits, what = "") {
  if (!edits.length) return show();
  if (pending) pending = { edits: [...pending.edits.filter(([path]) => !edits.some(([other]) => String(other) === String(path))), ...edits], what };
  else pending = { edits, what };
  next();
}

/** Sends what waits, as soon as the ranking that is under way has come; one that is slow is stopped. */
function next() {
  if (!running || running.ranked) return send();
  clearTimeout(running.stop);
  running.stop = setTimeout(send, Math.max(0, LONGEST_WAIT - (performance.now() - running.since)));
}

async function send() {
  running?.control.abort();
  clearTimeout(running?.stop);
  const mine = running = { control: new AbortController(), since: performance.now(), ranked: false, what: pending?.what ?? "" };
  const body = { text: state.text, edits: pending?.edits ?? [] };
  pending = null;
  answer.busy();
  try {
    for await (const piece of pieces("answer", body, mine.control.signal)) {
      if (running !== mine) return;
      take(piece, mine);
    }
    files.reachable(true);
  } catch (error) {
    if (error.name !== "AbortError") files.reachable(false);
  } finally {
    if (running === mine) running.ranked = true;
    if (pending && running === mine) send();
  }
}

function take(piece, mine) {
  if (piece.kind === "spec") {
    state.data = piece.data;
    state.faults = [];
    put(piece.text, mine.what);
    show();
  } else if (piece.kind === "wrong") {
    state.faults = piece.faults ?? piece.lines.map((text) => ({ text, line: null, path: [] }));
    if (piece.text !== undefined) put(piece.text, mine.what);
    answer.wrong(state.faults.map(said));
    show();
    mine.ranked = true;
  } else if (piece.kind === "ranking") {
    document.documentElement.dataset.ranked = String(Number(document.documentElement.dataset.ranked ?? 0) + 1);
    mine.ranked = true;
    answer.rank(piece);
    compare.rank(piece);
    sliders.renew();
    document.getElementById("more").hidden = false;
    if (pending) send();
  } else found(piece);
}

/** Pieces of a report, of an answer or of a closed loop. */
function found(piece) {
  if (piece.kind === "sections") {
    answer.sections(piece.sections);
    compare.boxes();
    compare.renew();
  } else if (piece.kind === "figures") answer.plots(piece.figures);
  else if (piece.kind === "still") answer.still(piece.name, piece.address);
}

const said = (fault) => [fault.line ? `line ${fault.line}` : "", fault.path.map((step) => (typeof step === "number" ? `${step + 1}` : step)).join("."), fault.text].filter(Boolean).join(": ");

// -- what is shown

function show() {
  form.show(state.data, state.faults);
  if (document.activeElement !== area) area.value = state.text;
  const box = document.getElementById("faults");
  box.replaceChildren(...state.faults.map((fault) => {
    const made = document.createElement("p");
    made.className = "fault";
    made.append(said(fault));
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = "show";
    button.addEventListener("click", () => reveal(fault));
    if (fault.line || fault.path.length) made.append(button);
    return made;
  }));
}

/** Shows the field of a fault, or its line. */
function reveal(fault) {
  if (!document.getElementById("form").hidden && form.focus(fault.path)) return;
  choose("yaml");
  const lines = area.value.split("\n"), start = lines.slice(0, (fault.line ?? 1) - 1).join("\n").length + (fault.line > 1 ? 1 : 0);
  area.focus();
  area.setSelectionRange(start, start + (lines[(fault.line ?? 1) - 1] ?? "").length);
}

let wait = 0;
area.addEventListener("input", () => {
  clearTimeout(wait);
  wait = setTimeout(() => { put(area.value, "yaml"); pending = null; send(); }, 350);
});
area.addEventListener("blur", () => { if (area.value === state.text) area.value = state.text; });

function choose(name) {
  for (const tab of document.querySelectorAll('[role="tab"]')) {
    const here = tab.id === `tab-${name}`;
    tab.setAttribute("aria-selected", here);
    tab.tabIndex = here ? 0 : -1;
    document.getElementById(tab.getAttribute("aria-controls")).hidden = !here;
  }
}

for (const tab of document.querySelectorAll('[role="tab"]')) {
  tab.addEventListener("click", () => choose(tab.id.slice(4)));
  tab.addEventListener("keydown", (event) => {
    if (event.key !== "ArrowLeft" && event.key !== "ArrowRight") return;
    const other = tab.id === "tab-form" ? "yaml" : "form";
    choose(other);
    document.getElementById(`tab-${other}`).focus();
  });
}

document.getElementById("loop").addEventListener("click", async ({ currentTarget }) => {
  currentTarget.disabled = true;
  currentTarget.textContent = "simulating …";
  const text = state.text;
  try {
    for await (const piece of pieces("loop", { text })) {
      if (text !== state.text) break;
      if (piece.kind === "wrong") files.notice(piece.lines.join("; "));
      else found(piece);
    }
  } catch {
    files.reachable(false);
  }
  currentTarget.disabled = false;
  currentTarget.textContent = "Simulate in closed loop";
  document.querySelector('[data-name="loop"], [data-name="closed_loop"]')?.scrollIntoView();
});

// -- from the start

watch(() => {
  document.getElementById("undo").disabled = !state.past.length;
  document.getElementById("redo").disabled = !state.future.length;
  document.getElementById("unsaved").hidden = state.text === state.saved && state.mark !== null;
  document.title = `${state.text === state.saved ? "" : "• "}${state.name} – drivesizer`;
  clearTimeout(keeping);
  keeping = setTimeout(async () => history.replaceState(null, "", `#${await packed()}`), 300);
});
let keeping = 0;

function again(step) {
  step();
  area.value = state.text;
  pending = null;
  send();
}
document.getElementById("undo").addEventListener("click", () => again(undo));
document.getElementById("redo").addEventListener("click", () => again(redo));

function restart(text) {
  put(text);
  area.value = text;
  pending = null;
  send();
}

async function start() {
  form.prepare(await get("schema.json"), edit, sliders.open);
  sliders.prepare(edit);
  catalogue.prepare({ edit, again: () => restart(state.text), notice: files.notice });
  files.prepare(restart);
  const file = await get("spec");
  Object.assign(state, { text: file.text, saved: file.text, mark: file.mark, name: file.name });
  document.getElementById("file").textContent = file.name;
  let opened = [];
  if (location.hash.length > 1) {
    try {
      const kept = await unpacked(location.hash.slice(1));
      state.text = kept.text;
      opened = kept.sliders;
    } catch {
      files.notice("the link was damaged: the file is shown");
    }
  }
  if (file.wrong) files.notice(`${file.name}: cannot be read (${file.wrong}); the page starts with another spec`);
  await send();
  for (const path of opened) if (Array.isArray(path)) sliders.open(path);
}

start().catch(() => files.reachable(false));
