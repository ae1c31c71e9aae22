// One's own catalogues, tables and data sheets: dropped or pasted, checked, known by their names until the server ends.

import { drawnIn } from "./answer.js";
import { counted } from "./catalogue_filter.js";
import { button, element } from "./dom.js";
import { handed } from "./files.js";
import { post, whole } from "./requests.js";
import { state, watch } from "./state.js";

const LARGEST = 16_000_000, FOLDER = "dropped/";
const input = element("input", { type: "file", accept: ".yaml,.yml,.csv,.tsv,.txt,.xlsx,.pdf,.json,.cfg,.xml,.mjcf,.log,.wpilog", hidden: true, aria: { label: "catalogue, table, data sheet or log" } });
const said = element("div", { className: "checked", role: "status" }), kept = element("div", { className: "own" });
const names = new Map(); // that the server has, with the catalogue that it made of a table
let act = {}, saved = null;

/** `choose` puts catalogues into the spec, `open` shows the dialog, `changed` says that a catalogue has come or gone. */
export function prepare(does) {
  act = does;
  input.addEventListener("change", () => { take(input.files[0]); input.value = ""; });
  addEventListener("dragover", (event) => { if (event.dataTransfer?.types.includes("Files")) event.preventDefault(); });
  addEventListener("drop", dropped);
  act.dialog.addEventListener("paste", pasted);
  watch(beside);
}

export function place() {
  const zone = element("div", { className: "drop" }, element("p", {}, "Drop a catalogue, a table of parts, a data sheet or the log of a drive here, paste rows of a table with their head, or ", button("choose a file", () => input.click())), input);
  zone.addEventListener("dragenter", () => zone.classList.add("over"));
  zone.addEventListener("dragleave", (event) => { if (!zone.contains(event.relatedTarget)) zone.classList.remove("over"); });
  return element("div", {}, zone, said, kept);
}

/** A file that is dropped anywhere: without this the browser would leave the page for it. */
async function dropped(event) {
  const [file] = event.dataTransfer?.files ?? [];
  if (!file) return;
  event.preventDefault();
  for (const zone of document.querySelectorAll(".drop.over")) zone.classList.remove("over");
  if (!act.dialog.open) {
    if (/\.ya?ml$/.test(file.name) && !/^catalog\s*:/m.test(await file.slice(0, 100_000).text())) {
      act.notice(`${file.name} is no catalogue; "Open …" takes a spec.`);
      return;
    }
    await act.open();
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
    const response = await post("catalogue", { name: file.name, content: await encoded(file), anyway, given, text: state.text });
    report(file, await response.json());
  } catch {
    say(`${file.name} was not checked: the server does not answer.`);
  }
}

function encoded(file) {
  return new Promise((done, failed) => {
    const reader = new FileReader();
    reader.addEventListener("load", () => done(reader.result.slice(reader.result.indexOf(",") + 1)));
    reader.addEventListener("error", () => failed(reader.error));
    reader.readAsDataURL(file);
  });
}

function say(text, ...more) {
  said.replaceChildren(element("p", { textContent: text }), ...more);
}

const lines = (found = [], className = "findings") => element("ul", { className }, ...found.map((text) => element("li", { textContent: text })));

function report(file, found) {
  if (found.kind === "superseded") return;
  if (found.kind === "fit") {
    const fit = element("div", { className: "fit", innerHTML: found.html }); // of the server's own templates, which escape every text
    act.fitted(element("h3", { tabIndex: -1, textContent: `${found.name}: the drive by its log` }), fit);
    say("");
    drawnIn(fit, found.figures);
  } else if (found.kind === "kept") {
    names.set(found.name, found.text);
    say(`${found.name}: ${counted(found.parts)}.`, ...words(file, found.given), lines(found.lines), lines(found.read, "note"));
    entries();
    act.changed(found.name);
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
function words(file, given) {
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
    element("p", {}, button("Search it too", () => act.choose({ catalogues: [name], add: true })), " ", button("Search it alone", () => act.choose({ catalogues: [name] })), " ", ...(text ? [button("save the file", () => handed(name.slice(FOLDER.length), text, "application/yaml")), " "] : []), button("give it up", () => leave(name))))));
}

/** Takes the names of those that the server has: a page that was loaded anew finds them again. */
export function known(catalogues) {
  const there = catalogues.filter((one) => one.own).map((one) => [one.name, names.get(one.name)]);
  names.clear();
  for (const one of there) names.set(...one);
  entries();
}

async function leave(name) {
  try {
    await post("catalogue", { name: name.slice(FOLDER.length), content: null });
    names.delete(name);
    said.replaceChildren();
    entries();
    act.changed(name);
  } catch {
    say("The server does not answer.");
  }
}

/** A spec that has just been saved may name what lies nowhere. */
async function beside() {
  const before = saved;
  saved = state.saved;
  if (!before || before === saved || !saved.includes(FOLDER)) return;
  known((await whole("catalogues", { text: saved }))[0].catalogues);
  const lacking = [...names.keys()].filter((name) => saved.includes(name)).map((name) => name.slice(FOLDER.length));
  if (lacking.length) act.notice(`${state.name} names what is in memory alone: put ${lacking.join(" and ")} into a folder ${FOLDER.slice(0, -1)} beside it, or it cannot be sized elsewhere.`, [], "", "own");
}
