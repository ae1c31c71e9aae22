// Files: the spec's own, those that the page makes, and whether the server is still there.

import { able, button, element } from "./dom.js";
import { open as openMenu } from "./menu.js";
import { get, post, whole } from "./requests.js";
import { changed, packed, state } from "./state.js";

const notices = document.getElementById("notices");
const REPORTS = { pdf: "Report, PDF", html: "Report, HTML", xlsx: "Report, XLSX", csv: "Report, CSV", json: "Report, JSON", "quote.csv": "Quote, CSV", "quote.xlsx": "Quote, XLSX" };
const ALSO = { wheeled_vehicle: " (AGV)" }; // what a kind is called as well
const AGAIN = 2000, SEEN = 10_000; // ms until the server is tried again, and until what is only said has been read
let exportable = {}; // formats that this server can write, with the programs that read them
let page = { restart: () => {}, again: () => {}, settled: async () => {}, unmade: () => [], turn: () => {} };

/** Says something above the page, until it is closed; buttons are pairs of words and what they do. */
export function notice(text, buttons = [], kind = "", name = text) {
  if ([...notices.children].some((one) => one.name === name)) return;
  const made = element("p", { className: `notice ${kind}` }, element("span", { textContent: text }));
  made.name = name;
  for (const [words, does] of [...buttons, ["close", () => {}]]) made.append(button(words, () => { leave(made); does(); }));
  notices.append(made);
  if (kind === "said" && name !== "making") setTimeout(() => leave(made), SEEN);
}

/** Takes a notice away; the keyboard goes on at the next one, or at the tools. */
function leave(made) {
  const had = made.contains(document.activeElement);
  made.remove();
  if (had) (notices.querySelector("button") ?? document.getElementById("save")).focus();
}

/** Takes away what is done. */
export function withdraw(name) {
  for (const one of [...notices.children]) if (one.name === name) leave(one);
}

// -- the server

let away = false;

export const gone = () => away;

export function reachable(there) {
  if (there) {
    if (away) withdraw("gone");
    away = false;
    return;
  }
  if (away) return;
  away = true;
  notice("The server does not answer. Nothing is lost: this tab keeps the spec, and Download, Spec saves it, with what is typed in the form since at its end. Start drivesizer serve again to go on.", [], "", "gone");
  const retry = async () => {
    try {
      await get("spec");
      reachable(true);
      if (state.text) page.again();
      else location.reload(); // it was away from the start
    } catch {
      setTimeout(retry, AGAIN);
    }
  };
  setTimeout(retry, AGAIN);
}

// -- the spec's file

async function save(anyway = false) {
  let found;
  await page.settled();
  try {
    const text = state.text;
    found = await (await post("save", { text, mark: state.mark, anyway })).json();
    if (found.kind === "saved") {
      Object.assign(state, { saved: text, mark: found.mark });
      changed();
      for (const name of ["changed", "saving", "lacking", "own"]) withdraw(name);
      const own = found.dropped.map((name) => name.split("/").at(-1)).join(" and ");
      if (own) notice(`${state.name} names what is in memory alone: put ${own} into a folder dropped beside it, or it cannot be sized elsewhere.`, [], "", "own");
      return;
    }
  } catch {
    reachable(false);
    return;
  }
  if (found.kind === "changed") differs();
  else {
    withdraw("saving");
    notice(`not saved: ${found.lines.join("; ")}`, [], "", "saving");
  }
}

/** Another program has written the file: the user decides. */
export function differs() {
  withdraw("changed");
  notice(`${state.name} has been changed by another program.`, [["load it", load], ["write mine over it", () => save(true)]], "", "changed");
}

async function load() {
  const file = await get("spec");
  Object.assign(state, { saved: file.text, mark: file.mark });
  page.restart(file.text);
}

/** Looks whether another program has written the file. */
async function look() {
  if (away || document.hidden) return;
  try {
    const file = await get("spec");
    if (file.mark !== null && file.mark !== state.mark) differs();
    if (file.mark === null && state.mark !== null) {
      state.mark = null;
      notice(`${state.name} is no longer there; Save writes it again.`, [], "", "lacking");
      changed();
    }
  } catch {
    reachable(false);
  }
}

/** Gives the user a file. */
export function handed(name, content, kind = "application/octet-stream") {
  const address = URL.createObjectURL(new Blob([content], { type: kind }));
  const link = element("a", { href: address, download: name });
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(address), 10_000);
}

async function download(job, form) {
  await page.settled();
  if (job === "spec") return handed(state.name, state.text.replace(/\n*$/, "\n") + page.unmade().join(""), "application/yaml");
  withdraw("no file");
  notice("making the file …", [], "said", "making");
  try {
    const [file] = await whole(job, { text: state.text, form });
    const stem = state.name.replace(/\.ya?ml$/, "");
    handed(file.name.replace(/^(report|drive|quote)/, `${stem}-$1`), Uint8Array.fromBase64(file.content));
  } catch (error) {
    notice(`no file: ${error.message}`, [], "", "no file");
  }
  return withdraw("making");
}

const by = (id) => document.getElementById(id);

/** Makes the buttons of the page's head work. */
export function prepare(given) {
  page = given;
  const does = { download: () => openMenu(by("download"), "download", downloads()), save: () => save(), open: () => by("opened").click(), link };
  for (const [id, done] of Object.entries(does)) by(id).addEventListener("click", done);
  by("opened").addEventListener("change", opened);
  starters(by("new"));
  addEventListener("focus", look);
  addEventListener("keydown", keyed);
  addEventListener("beforeunload", (event) => { if (away && state.text !== state.saved) event.preventDefault(); });
}

function downloads() {
  const entry = (job) => ([form, name]) => ({ name, does: () => download(job, form) });
  return [{ name: "Spec, YAML", does: () => download("spec") }, { head: "with the closed loop" }, ...Object.entries(REPORTS).map(entry("report")),
    { head: "the drive for other programs" }, ...Object.entries(exportable).map(entry("export"))];
}

async function opened() {
  const [file] = by("opened").files;
  if (file && file.size < 2_000_000) page.restart(await file.text());
  else if (file) notice(`${file.name} is larger than 2 MB`);
  by("opened").value = "";
}

async function link() {
  await page.settled();
  const address = `${location.href.split("#")[0]}#${await packed()}`;
  await navigator.clipboard.writeText(address).then(() => notice("The link holds the spec and the sliders, for a browser on this machine.", [], "said"), () => notice(address));
}

function keyed(event) {
  if (!(event.ctrlKey || event.metaKey) || event.altKey) return;
  const typing = /^(INPUT|TEXTAREA)$/.test(event.target.tagName) && event.target.type !== "range";
  const key = event.key.toLowerCase();
  if (key === "s") {
    event.preventDefault();
    save();
  } else if (!typing && (key === "z" || key === "y")) {
    event.preventDefault();
    const wanted = by(key === "y" || event.shiftKey ? "redo" : "undo");
    if (able(wanted)) wanted.click();
  }
}

/** Specs to start with, each with the first line of what it says about itself. */
async function starters(list) {
  const { kinds, exports } = await get("starters.json");
  exportable = exports;
  const choices = Object.entries(kinds).map(([name, text]) => ({
    name: name.replaceAll("_", " ") + (ALSO[name] ?? ""), help: /^# (.*?)\.?$/m.exec(text)?.[1], does: () => { page.turn("machine"); page.restart(text); },
  }));
  list.addEventListener("click", () => openMenu(list, "new spec", choices));
}
