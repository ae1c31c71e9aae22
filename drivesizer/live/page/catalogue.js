// The catalogues: parts that meet conditions, one part with its curves, parts side by side, and one's own catalogues.

import { drawnIn } from "./answer.js";
import { button, element, words } from "./dom.js";
import * as filter from "./catalogue_filter.js";
import * as own from "./catalogue_own.js";
import { whole } from "./requests.js";
import { state } from "./state.js";

const dialog = document.getElementById("browser"), opener = document.getElementById("catalogues");
const found = element("section", { className: "found", aria: { label: "parts" } });
let act = () => {};
let built = false;

/** `edit` makes edits of the spec, `again` has it sized anew, `notice` says something above the page. */
export function prepare({ edit, again, notice }) {
  act = edit;
  opener.setAttribute("aria-haspopup", "dialog");
  opener.addEventListener("click", open);
  own.prepare({ dialog, choose, open, changed: (name) => renew(name, again), fitted, notice });
}

export async function open() {
  if (!built) build();
  if (!dialog.open) {
    reading = false;
    dialog.showModal();
  }
  await renew();
}

function build() {
  built = true;
  const close = button("Close", () => dialog.close());
  const head = element("div", { className: "head" }, element("h2", { id: "browser-head", textContent: "Catalogues" }), close);
  const box = filter.build(look, own.place());
  dialog.append(head, element("div", { className: "browse" }, box, found));
  dialog.addEventListener("close", () => opener.focus());
}

/** The catalogues as they are now; of one that has changed the spec is sized anew. */
async function renew(name = null, again = () => {}) {
  if (name !== null && state.text.includes(name)) again();
  if (!built) return;
  try {
    const [piece] = await whole("catalogues", { text: state.text });
    own.known(piece.catalogues);
    filter.show(piece, name);
    if (!reading) await look(); // what is being read stays
  } catch (error) {
    wrong(error);
  }
}

let requested = 0;
let reading = false; // a part, or parts side by side, in place of the list

/** Lists the parts that meet the conditions; the newest request counts. */
async function look(start = 0) {
  reading = false;
  const mine = ++requested, wanted = filter.wanted();
  found.setAttribute("aria-busy", "true");
  try {
    const [piece] = await whole("parts", { text: state.text, ...wanted, sort: sortOf(wanted.section), start });
    if (mine !== requested || piece.kind === "superseded") return;
    filter.faults(piece.faults ?? []);
    if (piece.kind === "parts") list(piece);
  } catch (error) {
    if (mine === requested) wrong(error);
  }
  found.removeAttribute("aria-busy");
}

async function visit({ catalogue, part: number }) {
  await turned("part", { catalogue, section: filter.kind(), part: number }, showPart);
}

async function compare(rows) {
  await turned("beside", { section: filter.kind(), parts: rows.map((row) => [row.catalogue, row.part]) }, sideBySideOf);
}

/** Another view in place of the list. */
async function turned(job, body, show) {
  const mine = ++requested;
  reading = true;
  try {
    const [piece] = await whole(job, { text: state.text, ...body });
    if (mine === requested) show(piece);
  } catch (error) {
    if (mine === requested) wrong(error);
  }
}

/** The fit of a log in place of the list. */
function fitted(head, body) {
  reading = true;
  requested += 1;
  inPlace(head, body);
}

function inPlace(head, ...body) {
  found.replaceChildren(element("p", {}, button("Back to the list", back)), head, ...body);
  tabled(found);
  head.focus();
}

function back() {
  reading = false;
  requested += 1;
  listAgain();
}

/** Puts what was chosen into the spec. */
async function choose(body) {
  try {
    const [{ edits }] = await whole("choose", { text: state.text, ...body });
    dialog.close();
    act(edits);
  } catch (error) {
    refused(error);
  }
}

// -- the list of parts: its figures as columns, sorted by the server, some hundred rows at once

const MOST = 4; // parts side by side
const sorts = {}; // by kind of part: a column, -column for the largest first
let chosen = []; // rows to set side by side
let last = null; // what was listed

const sortOf = (section) => sorts[section] ?? "";

function wrong(error) {
  found.replaceChildren(element("p", { className: "fault", role: "alert", textContent: error.message }));
}

/** Says above what is shown why something was not done. */
function refused(error) {
  for (const old of found.querySelectorAll(":scope > .fault")) old.remove();
  const said = element("p", { className: "fault", role: "alert", tabIndex: -1, textContent: error.message });
  found.prepend(said);
  said.focus();
}

function listAgain() {
  if (last) list(last);
  (found.querySelector(".opened") ?? found.querySelector("tbody button"))?.focus();
}

function list(piece) {
  if (last?.section !== piece.section) chosen = [];
  const opened = found.querySelector(".opened")?.value ?? last?.opened;
  last = { ...piece, opened };
  found.replaceChildren(summary(piece), pages(piece), piece.rows.length ? table(piece) : "", bar());
  tabled(found);
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
  const back = button("previous", () => look(Math.max(0, piece.start - step)), { disabled: piece.start === 0 });
  const on = button("next", () => look(end), { disabled: end >= piece.found });
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
  const sorter = button(one.head, () => { sorts[piece.section] = now === "ascending" ? `-${one.name}` : one.name; look(); });
  const made = element("th", { scope: "col", className: one.text ? "" : "n", aria: { sort: now } }, sorter);
  if (one.unit) made.append(element("small", { textContent: one.unit }));
  return made;
}

function line(row, piece) {
  const box = element("input", { type: "checkbox", checked: chosen.some((one) => same(one, row)), aria: { label: `${row.part}: side by side` } });
  box.addEventListener("change", () => pick(row, box));
  const opens = button(row.part, () => { last.opened = row.part; for (const old of document.querySelectorAll("#browser .opened")) old.classList.remove("opened"); opens.classList.add("opened"); visit(row); }, { className: row.part === last.opened ? "part-link opened" : "part-link" });
  const name = element("th", { scope: "row" }, opens, row.excluded ? element("small", { textContent: "excluded from sizing" }) : "");
  const cells = row.cells.map((cell, n) => element("td", { className: piece.columns[n].text ? "" : "n", textContent: cell || "–" }));
  return element("tr", {}, element("td", {}, box), name, element("td", { textContent: row.family }), element("td", { textContent: row.maker, title: row.catalogue }), ...cells);
}

// -- side by side

const same = (a, b) => a.part === b.part && a.catalogue === b.catalogue;

function pick(row, box) {
  chosen = chosen.filter((one) => !same(one, row));
  if (box.checked) chosen = [...chosen, row];
  if (chosen.length > MOST) {
    box.checked = false;
    chosen.pop();
  }
  sideBySide();
}

const comparing = button("Compare", () => compare(chosen));
const none = button("none of them", () => { chosen = []; for (const box of document.querySelectorAll("#browser .listed input")) box.checked = false; sideBySide(); });
const said = element("span");
const box = element("p", { className: "chosen", role: "status" }, said, " ", comparing, " ", none);
const bar = () => box;

function sideBySide() {
  box.hidden = !chosen.length;
  said.textContent = `${chosen.map((one) => one.part).join(", ")}${chosen.length === 1 ? ": choose another one" : ""}`;
  comparing.disabled = chosen.length < 2;
}

// -- one part as a data sheet with its curves

function showPart(piece) {
  const head = element("h3", { tabIndex: -1 }, `${piece.head} `, element("strong", { textContent: piece.part }));
  const below = element("p", { className: "note", textContent: `${piece.role} in ${piece.catalogue}` });
  const [sheet, does] = [piece.sheet, piece.does].map((innerHTML) => element("div", { innerHTML })); // of the server's own templates, which escape every text
  sheet.append(sources(piece.documents));
  inPlace(head, below, uses(piece), element("div", { className: "sheets" }, sheet, does));
  drawnIn(does, piece.figures);
}

/** Buttons that put it into the spec. */
function uses(piece) {
  if (!piece.use) return "";
  const axes = piece.use.axes ? Object.keys(state.data?.axes ?? {}) : [];
  const axis = element("select", { aria: { label: "for which axis" } }, element("option", { value: "", textContent: "all axes" }), ...axes.map((name) => element("option", { value: name, textContent: name })));
  const does = (family) => () => choose({ part: [piece.catalogue, piece.section, piece.part], family, axis: axis.value });
  const made = element("p", { className: "uses" }, button("Use this part", does(false)));
  if (piece.use.family) made.append(button(`Only this family, ${piece.use.family}`, does(true)));
  if (axes.length > 1) made.append(axis);
  return made;
}

/** The documents behind the figures; only an address of the web is a link. */
function sources(documents) {
  return element("ol", { className: "documents" }, ...documents.map(([document, date, url]) => {
    const made = element("li", {}, [document, date].filter(Boolean).join(", "));
    if (/^https?:\/\//.test(url)) made.append(" ", element("a", { href: url, rel: "noopener noreferrer", target: "_blank", textContent: url }));
    else if (url) made.append(` ${url}`);
    return made;
  }));
}

// -- side by side

function sideBySideOf(piece) {
  inPlace(element("h3", { tabIndex: -1, textContent: "Side by side" }), element("div", { innerHTML: piece.html })); // of the server's own templates
}
