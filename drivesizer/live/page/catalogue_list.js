// The list of parts: its figures as columns, sorted by the server, some hundred rows at once.

import { button, element, words } from "./dom.js";

const MOST = 4; // parts side by side
const sorts = {}; // by kind of part: a column, -column for the largest first
let chosen = []; // rows to set side by side
let last = null; // what was listed
let act = {};

/** `open` shows a part, `compare` several, `look` lists anew from a row on. */
export function prepare(does) { act = does; }

export const sort = (section) => sorts[section] ?? "";

export function wrong(place, error) {
  place.replaceChildren(element("p", { className: "fault", role: "alert", textContent: error.message }));
}

/** Says above what is shown why something was not done. */
export function refused(place, error) {
  for (const old of place.querySelectorAll(":scope > .fault")) old.remove();
  const said = element("p", { className: "fault", role: "alert", tabIndex: -1, textContent: error.message });
  place.prepend(said);
  said.focus();
}

export function again(place) {
  if (last) show(place, last);
  (place.querySelector(".opened") ?? place.querySelector("tbody button"))?.focus();
}

export function show(place, piece) {
  if (last?.section !== piece.section) chosen = [];
  const opened = place.querySelector(".opened")?.value ?? last?.opened;
  last = { ...piece, opened };
  place.replaceChildren(summary(piece), pages(piece), piece.rows.length ? table(piece) : "", bar());
  tabled(place);
  sideBySide();
}

/** How many there are, and what the columns mean. */
function summary(piece) {
  const some = piece.found === 1 ? "1 part" : `${piece.found.toLocaleString("en")} ${words(piece.section)}`;
  const lines = [`${some}${piece.note && piece.found ? `; ${piece.note}` : ""}.`];
  if (piece.undecided) lines.push(`${piece.undecided.toLocaleString("en")} more may fit: a required figure is unknown.`);
  if (piece.excluded && !piece.rows.some((row) => row.excluded)) lines.push(`${piece.excluded.toLocaleString("en")} more ${piece.excluded === 1 ? "is" : "are"} excluded from sizing by a note.`);
  return element("p", { className: "summary", role: "status", textContent: lines.join(" ") });
}

function pages(piece) {
  const end = piece.start + piece.rows.length, step = 200;
  const made = element("p", { className: "pages", hidden: piece.found === piece.rows.length });
  const back = button("previous", () => act.look(Math.max(0, piece.start - step)), { disabled: piece.start === 0 });
  const on = button("next", () => act.look(end), { disabled: end >= piece.found });
  made.append(back, ` ${(piece.start + 1).toLocaleString("en")} to ${end.toLocaleString("en")} of ${piece.found.toLocaleString("en")} `, on);
  return made;
}

function table(piece) {
  const names = [{ name: "part", head: "part", text: true }, { name: "family", head: "family", text: true }, { name: "manufacturer", head: "maker", text: true }, ...piece.columns];
  const head = element("tr", {}, element("th", { scope: "col" }, element("span", { className: "hidden", textContent: "side by side" })), ...names.map((one) => headOf(one, piece)));
  const made = element("table", { className: "listed" }, element("thead", {}, head), element("tbody", {}, ...piece.rows.map((row) => line(row, piece))));
  return element("div", { className: "framed" }, element("div", { className: "scroll", tabIndex: 0, role: "region", aria: { label: words(piece.section) } }, made));
}

function headOf(one, piece) {
  const now = piece.sort === one.name ? "ascending" : piece.sort === `-${one.name}` ? "descending" : "none";
  const sorter = button(one.head, () => { sorts[piece.section] = now === "ascending" ? `-${one.name}` : one.name; act.look(); });
  const made = element("th", { scope: "col", className: one.text ? "" : "n", aria: { sort: now } }, sorter);
  if (one.unit) made.append(element("small", { textContent: one.unit }));
  return made;
}

function line(row, piece) {
  const box = element("input", { type: "checkbox", checked: chosen.some((one) => same(one, row)), aria: { label: `${row.part}: side by side` } });
  box.addEventListener("change", () => choose(row, box));
  const opens = button(row.part, () => { last.opened = row.part; for (const old of document.querySelectorAll("#browser .opened")) old.classList.remove("opened"); opens.classList.add("opened"); act.open(row); }, { className: row.part === last.opened ? "part-link opened" : "part-link" });
  const name = element("th", { scope: "row" }, opens, row.excluded ? element("small", { textContent: "excluded from sizing" }) : "");
  const cells = row.cells.map((cell, n) => element("td", { className: piece.columns[n].text ? "" : "n", textContent: cell || "–" }));
  return element("tr", {}, element("td", {}, box), name, element("td", { textContent: row.family }), element("td", { textContent: row.maker, title: row.catalogue }), ...cells);
}

// -- side by side

const same = (a, b) => a.part === b.part && a.catalogue === b.catalogue;

function choose(row, box) {
  chosen = chosen.filter((one) => !same(one, row));
  if (box.checked) chosen = [...chosen, row];
  if (chosen.length > MOST) {
    box.checked = false;
    chosen.pop();
  }
  sideBySide();
}

const compare = button("Compare", () => act.compare(chosen));
const none = button("none of them", () => { chosen = []; for (const box of document.querySelectorAll("#browser .listed input")) box.checked = false; sideBySide(); });
const said = element("span");
const box = element("p", { className: "chosen", role: "status" }, said, " ", compare, " ", none);
const bar = () => box;

function sideBySide() {
  box.hidden = !chosen.length;
  said.textContent = `${chosen.map((one) => one.part).join(", ")}${chosen.length === 1 ? ": choose another one" : ""}`;
  compare.disabled = chosen.length < 2;
}
