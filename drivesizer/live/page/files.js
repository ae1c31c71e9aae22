// Files: the spec's own, those that the page makes, and whether the server is still there.

import { get, post, whole } from "./requests.js";
import { changed, packed, state } from "./state.js";

const notices = document.getElementById("notices");
const REPORTS = { pdf: "Report, PDF", html: "Report, HTML", xlsx: "Report, XLSX", csv: "Report, CSV", json: "Report, JSON" };
const EXPORTS = { mjcf: "MuJoCo", urdf: "URDF", sdf: "Gazebo SDF", ros2_control: "ros2_control", fmu: "FMU", json: "drive as JSON" };
const AGAIN = 2000; // ms
let restart = () => {};

function element(tag, properties = {}, ...children) {
  const made = Object.assign(document.createElement(tag), properties);
  made.append(...children);
  return made;
}

/** Says something above the page, until it is closed; buttons are pairs of words and what they do. */
export function notice(text, buttons = [], kind = "", name = text) {
  if ([...notices.children].some((one) => one.name === name)) return;
  const made = element("p", { className: `notice ${kind}` }, element("span", { textContent: text }));
  made.name = name;
  for (const [words, does] of [...buttons, ["close", () => {}]]) {
    const button = element("button", { type: "button", textContent: words });
    button.addEventListener("click", () => { made.remove(); does(); });
    made.append(button);
  }
  notices.append(made);
}

function withdraw(name) {
  for (const one of [...notices.children]) if (one.name === name) one.remove();
}

// -- the server

let gone = false;

export function reachable(there) {
  if (there) {
    if (gone) withdraw("gone");
    gone = false;
    return;
  }
  if (gone) return;
  gone = true;
  notice("The server does not answer. Nothing is lost: this tab keeps the spec, and Download, Spec saves it. Start drivesizer serve again to go on.", [], "", "gone");
  const retry = async () => {
    try {
      await get("spec");
      reachable(true);
      restart(state.text);
    } catch {
      setTimeout(retry, AGAIN);
    }
  };
  setTimeout(retry, AGAIN);
}

// -- the spec's file

async function save(anyway = false) {
  let found;
  try {
    const text = state.text;
    found = await (await post("save", { text, mark: state.mark, anyway })).json();
    if (found.kind === "saved") {
      Object.assign(state, { saved: text, mark: found.mark });
      changed();
      notices.querySelectorAll(".said").forEach((one) => one.remove());
      withdraw("changed");
      return;
    }
  } catch {
    reachable(false);
    return;
  }
  if (found.kind === "changed") differs();
  else notice(`not saved: ${found.lines.join("; ")}`);
}

function differs() {
  withdraw("changed");
  notice(`${state.name} has been changed by another program.`, [["load it", load], ["write mine over it", () => save(true)]], "", "changed");
}

async function load() {
  const file = await get("spec");
  Object.assign(state, { saved: file.text, mark: file.mark });
  restart(file.text);
}

/** Looks whether another program has written the file. */
async function look() {
  if (gone || document.hidden) return;
  try {
    const file = await get("spec");
    if (file.mark !== null && file.mark !== state.mark) differs();
    if (file.mark === null && state.mark !== null) {
      state.mark = null;
      notice(`${state.name} is no longer there; Save writes it again.`);
      changed();
    }
  } catch {
    reachable(false);
  }
}

function handed(name, content, kind = "application/octet-stream") {
  const address = URL.createObjectURL(new Blob([content], { type: kind }));
  const link = element("a", { href: address, download: name });
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(address), 10_000);
}

async function download(what) {
  if (what === "spec") return handed(state.name, state.text, "application/yaml");
  const [job, form] = what.split(":");
  notice("making the file …", [], "said", "making");
  try {
    const [file] = await whole(job, { text: state.text, form });
    const bytes = Uint8Array.from(atob(file.content), (letter) => letter.charCodeAt(0));
    const stem = state.name.replace(/\.ya?ml$/, "");
    handed(file.name.replace(/^(report|drive)/, `${stem}-$1`), bytes);
  } catch (error) {
    notice(`no file: ${error.message}`);
  }
  withdraw("making");
}

export function prepare(onText) {
  restart = onText;
  const by = (id) => document.getElementById(id);
  const list = by("download");
  list.append(element("option", { value: "spec", textContent: "Spec, YAML" }));
  for (const [form, words] of Object.entries(REPORTS)) list.append(element("option", { value: `report:${form}`, textContent: words }));
  for (const [form, words] of Object.entries(EXPORTS)) list.append(element("option", { value: `export:${form}`, textContent: words }));
  list.addEventListener("change", () => { const what = list.value; list.value = ""; if (what) download(what); });
  by("save").addEventListener("click", () => save());
  by("open").addEventListener("click", () => by("opened").click());
  by("opened").addEventListener("change", async () => {
    const [file] = by("opened").files;
    if (file && file.size < 2_000_000) restart(await file.text());
    else if (file) notice(`${file.name} is larger than 2 MB`);
    by("opened").value = "";
  });
  by("link").addEventListener("click", async () => {
    const address = `${location.href.split("#")[0]}#${await packed()}`;
    await navigator.clipboard.writeText(address).then(() => notice("The link holds the spec and the sliders, for a browser on this machine.", [], "said"), () => notice(address));
  });
  starters(by("new"));
  addEventListener("focus", look);
  addEventListener("keydown", (event) => {
    if (!(event.ctrlKey || event.metaKey) || event.altKey) return;
    const typing = /^(INPUT|TEXTAREA)$/.test(event.target.tagName) && event.target.type !== "range";
    if (event.key === "s") { event.preventDefault(); save(); }
    else if (event.key === "z" && !typing) { event.preventDefault(); by(event.shiftKey ? "redo" : "undo").click(); }
  });
  addEventListener("beforeunload", (event) => { if (gone && state.text !== state.saved) event.preventDefault(); });
}

async function starters(list) {
  const { kinds } = await get("starters.json");
  for (const name of Object.keys(kinds)) list.append(element("option", { value: name, textContent: name.replaceAll("_", " ") }));
  list.addEventListener("change", () => { const name = list.value; list.value = ""; if (name) restart(kinds[name]); });
}
