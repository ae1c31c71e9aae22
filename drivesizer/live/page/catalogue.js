// The catalogues: parts that meet conditions, one part with its curves, parts side by side, and one's own catalogues.

import { drawnIn } from "./answer.js";
import { button, choice, element, words } from "./dom.js";
import * as filter from "./catalogue_filter.js";
import { handed } from "./files.js";
import { post, whole } from "./requests.js";
import { state } from "./state.js";

const dialog = document.getElementById("browser"), opener = document.getElementById("catalogues");
const found = element("section", { className: "found", aria: { label: "parts" } });
let act, again, notice;

/** `edit` makes edits of the spec, `again` has it sized anew, `notice` says something above the page. */
export function prepare(does) {
  ({ edit: act, again, notice } = does);
  opener.addEventListener("click", open);
  input.addEventListener("change", () => { take(input.files[0]); input.value = ""; });
  addEventListener("dragover", (event) => { if (event.dataTransfer?.types.includes("Files")) event.preventDefault(); });
  addEventListener("drop", dropped);
  dialog.addEventListener("paste", pasted);
}

async function open() {
  if (!dialog.childElementCount) build();
  reading = false;
  dialog.showModal();
  await renew();
}

function build() {
  const close = button("Close", () => dialog.close());
  const head = element("div", { className: "head" }, element("h2", { id: "browser-head", textContent: "Catalogues" }), close);
  const box = filter.build(look, ownPlace());
  dialog.append(head, element("div", { className: "browse" }, box, found));
}

/** The catalogues as they are now; of one that has changed the spec is sized anew. */
async function renew(name = null) {
  if (name !== null && state.text.includes(name)) again();
  if (!dialog.childElementCount) return;
  try {
    const [piece] = await whole("catalogues", { text: state.text });
    ownKnown(piece.catalogues);
    filter.show(piece, name);
    if (!reading) await look(); // what is being read stays
  } catch (error) {
    wrong(error);
  }
}

let requested = 0;
let reading = false; // a part, or parts side by side, in place of the list

/** Lists the parts that meet the conditions. */
async function look(start = 0) {
  const wanted = filter.wanted();
  reading = false;
  found.setAttribute("aria-busy", "true");
  await turned("parts", { ...wanted, sort: sorts[wanted.section] ?? "", start }, (piece) => {
    if (piece.kind === "superseded") return;
    filter.faults(piece.faults ?? []);
    if (piece.kind === "parts") list(piece);
  });
  found.removeAttribute("aria-busy");
}

/** Shows what a job finds; the newest request counts. */
async function turned(job, body, show) {
  const mine = ++requested;
  try {
    const [piece] = await whole(job, { text: state.text, ...body });
    if (mine === requested) show(piece);
  } catch (error) {
    if (mine === requested) wrong(error);
  }
}

/** Something in place of the list; what was requested before does not come any more. */
function inPlace(head, ...body) {
  reading = true;
  requested += 1;
  found.replaceChildren(element("p", {}, button("Back to the list", back)), head, ...body);
  tabled(found);
  head.focus();
}

function back() {
  reading = false;
  requested += 1;
  if (last) list(last);
  (found.querySelector(".opened") ?? found.querySelector("tbody button"))?.focus();
}

/** Puts what was chosen into the spec. */
async function choose(body) {
  try {
    const [{ edits }] = await whole("choose", { text: state.text, ...body });
    dialog.close();
    act(edits);
  } catch (error) {
    wrong(error);
  }
}

// -- the list of parts: its figures as columns, sorted by the server, some hundred rows at once

const sorts = {}; // by kind of part: a column, -column for the largest first
const chosen = choice(4, (row) => `${row.catalogue} ${row.part}`, sideBySide);
let last = null; // what was listed

/** Says above what is shown why something was not done. */
function wrong(error) {
  for (const old of found.querySelectorAll(":scope > .fault")) old.remove();
  found.prepend(element("p", { className: "fault", role: "alert", textContent: error.message }));
  found.scrollIntoView();
}

function list(piece) {
  if (last?.section !== piece.section) chosen.clear();
  last = { ...piece, opened: last?.opened };
  found.replaceChildren(summary(piece), pages(piece), piece.rows.length ? table(piece) : "", box);
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

/** The table of the document, whose heads sort and whose rows open. */
function table(piece) {
  const made = element("div", { innerHTML: piece.html }); // of the server's own templates, which escape every text
  for (const [n, head] of made.querySelectorAll("thead th").entries()) sorting(head, piece.columns[n], piece);
  for (const [n, line] of made.querySelectorAll("tbody tr").entries()) opening(line.cells[0], piece.rows[n]);
  return made.firstElementChild;
}

function sorting(head, name, piece) {
  const now = piece.sort === name ? "ascending" : piece.sort === `-${name}` ? "descending" : "none";
  head.setAttribute("aria-sort", now);
  head.replaceChildren(button(head.textContent, () => { sorts[piece.section] = now === "ascending" ? `-${name}` : name; look(); }));
}

function opening(cell, row) {
  const opens = button(row.part, () => {
    last.opened = row.part;
    turned("part", { catalogue: row.catalogue, section: filter.kind(), part: row.part }, showPart);
  }, { className: row.part === last.opened ? "part-link opened" : "part-link" });
  cell.replaceChildren(chosen.box(row, `${row.part}: side by side`), opens, row.excluded ? element("small", { textContent: "excluded from sizing" }) : "");
}

// -- side by side

const comparing = button("Compare", () => turned("beside", { section: filter.kind(), parts: chosen.list().map((row) => [row.catalogue, row.part]) }, sideBySideOf));
const none = button("none of them", () => { chosen.clear(); sideBySide(); });
const said = element("span");
const box = element("p", { className: "chosen", role: "status" }, said, " ", comparing, " ", none);

function sideBySideOf(piece) {
  inPlace(element("h3", { tabIndex: -1, textContent: "Side by side" }), element("div", { innerHTML: piece.html })); // of the server's own templates
}

function sideBySide() {
  const parts = chosen.list().map((row) => row.part);
  box.hidden = !parts.length;
  said.textContent = `${parts.join(", ")}${parts.length === 1 ? ": choose another one" : ""}`;
  comparing.disabled = parts.length < 2;
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

// -- one's own catalogues, tables, data sheets and logs: dropped or pasted, checked, known by name until the server ends

const LARGEST = 16_000_000, FOLDER = "dropped/";
const input = element("input", { type: "file", accept: ".yaml,.yml,.csv,.tsv,.txt,.xlsx,.pdf,.json,.cfg,.xml,.mjcf,.log,.wpilog", hidden: true, aria: { label: "catalogue, table, data sheet or log" } });
const checked = element("div", { className: "checked", role: "status" }), kept = element("div", { className: "own" });
const names = new Map(); // that the server has, with the catalogue that it made of a table

function ownPlace() {
  const zone = element("div", { className: "drop" }, element("p", {}, "Drop a catalogue, a table of parts, a data sheet or the log of a drive here, paste rows of a table with their head, or ", button("choose a file", () => input.click())), input);
  zone.addEventListener("dragenter", () => zone.classList.add("over"));
  zone.addEventListener("dragleave", (event) => { if (!zone.contains(event.relatedTarget)) zone.classList.remove("over"); });
  return element("div", {}, zone, checked, kept);
}

/** A file that is dropped anywhere: without this the browser would leave the page for it. */
async function dropped(event) {
  const [file] = event.dataTransfer?.files ?? [];
  if (!file) return;
  event.preventDefault();
  for (const zone of document.querySelectorAll(".drop.over")) zone.classList.remove("over");
  if (!dialog.open) {
    if (/\.ya?ml$/.test(file.name) && !/^catalog\s*:/m.test(await file.slice(0, 100_000).text())) {
      notice(`${file.name} is no catalogue; "Open …" takes a spec.`);
      return;
    }
    await open();
  }
  take(file);
}

/** Rows of a table as a spreadsheet or a shop's page gives them. */
function pasted(event) {
  const text = event.clipboardData?.getData("text/plain") ?? "";
  if (event.target.tagName !== "INPUT" && text.trim()) take(new File([text], "pasted.csv"));
}

async function take(file, anyway = false, given = {}) {
  if (!file) return;
  if (file.size > LARGEST) return say(`${file.name} is larger than ${LARGEST / 1e6} MB.`);
  say(`checking ${file.name} …`);
  try {
    const response = await post("catalogue", { name: file.name, content: (await file.bytes()).toBase64(), anyway, given, text: state.text });
    report(file, await response.json());
  } catch {
    say(`${file.name} was not checked: the server does not answer.`);
  }
}

function say(text, ...more) {
  checked.replaceChildren(element("p", { textContent: text }), ...more);
}

const lines = (found = [], className = "findings") => element("ul", { className }, ...found.map((text) => element("li", { textContent: text })));

function report(file, found) {
  if (found.kind === "superseded") return;
  if (found.kind === "fit") {
    const fit = element("div", { className: "fit", innerHTML: found.html }); // of the server's own templates, which escape every text
    inPlace(element("h3", { tabIndex: -1, textContent: `${found.name}: the drive by its log` }), fit);
    say("");
    drawnIn(fit, found.figures);
  } else if (found.kind === "kept") {
    names.set(found.name, found.text);
    say(`${found.name}: ${filter.counted(found.parts)}.`, ...givenOf(file, found.given), lines(found.lines), lines(found.read, "note"));
    entries();
    renew(found.name);
  } else if (found.kind === "contradictory") {
    const count = found.lines.length + found.more;
    say(`${file.name}: ${count === 1 ? "a figure contradicts" : `${count} figures contradict`} others and no note says why. It is not taken.`, lines(found.lines), lines(found.read, "note"),
      found.more ? element("p", { textContent: `and ${found.more} more` }) : "", button("take it all the same", () => take(file, true)));
  } else {
    say(`${file.name} is not taken:`, lines(found.lines ?? []));
  }
}

const KINDS = ["", "brushed", "brushless"];

/** What a table does not say of its parts, and may be said by the user. */
function givenOf(file, given) {
  if (!given) return [];
  const fields = Object.entries(given).map(([name, value]) => {
    const input = name === "kind" ? element("select", {}, ...KINDS.map((one) => element("option", { value: one, textContent: one, selected: one === value }))) : element("input", { type: "text", value });
    input.name = name;
    return element("label", { className: "field" }, name === "manufacturer" ? "maker" : name, input);
  });
  const again = () => take(file, false, Object.fromEntries(fields.map((one) => [one.lastChild.name, one.lastChild.value])));
  return [element("div", { className: "given" }, ...fields, button("read it so", again))];
}

// -- those that are here

function entries() {
  kept.replaceChildren(...[...names].map(([name, text]) => element("div", { className: "one" }, element("p", {}, element("strong", { textContent: name })),
    element("p", { className: "note", textContent: `Kept in memory until drivesizer serve ends. A spec finds it by this name: save the spec, and ${name.slice(FOLDER.length)} must lie beside it in a folder ${FOLDER.slice(0, -1)}.` }),
    element("p", {}, button("Search it too", () => choose({ catalogues: [name], add: true })), " ", button("Search it alone", () => choose({ catalogues: [name] })), " ", ...(text ? [button("save the file", () => handed(name.slice(FOLDER.length), text, "application/yaml")), " "] : []), button("give it up", () => leave(name))))));
}

/** Takes the names of those that the server has: a page that was loaded anew finds them again. */
function ownKnown(catalogues) {
  const there = catalogues.filter((one) => one.own).map((one) => [one.name, names.get(one.name)]);
  names.clear();
  for (const one of there) names.set(...one);
  entries();
}

async function leave(name) {
  try {
    await post("catalogue", { name: name.slice(FOLDER.length), content: null });
    names.delete(name);
    checked.replaceChildren();
    entries();
    renew(name);
  } catch {
    say("The server does not answer.");
  }
}
