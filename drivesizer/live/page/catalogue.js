// The catalogues: parts that meet conditions, one part with its curves, parts side by side, and one's own catalogues.

import { button, element } from "./dom.js";
import * as filter from "./catalogue_filter.js";
import * as list from "./catalogue_list.js";
import * as own from "./catalogue_own.js";
import * as part from "./catalogue_part.js";
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
  list.prepare({ open: (row) => visit(row), compare, look });
  part.prepare({ choose, back });
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
    list.wrong(found, error);
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
    const [piece] = await whole("parts", { text: state.text, ...wanted, sort: list.sort(wanted.section), start });
    if (mine !== requested || piece.kind === "superseded") return;
    filter.faults(piece.faults ?? []);
    if (piece.kind === "parts") list.show(found, piece);
  } catch (error) {
    if (mine === requested) list.wrong(found, error);
  }
  found.removeAttribute("aria-busy");
}

async function visit({ catalogue, part: number }) {
  await turned("part", { catalogue, section: filter.kind(), part: number }, part.show);
}

async function compare(rows) {
  await turned("beside", { section: filter.kind(), parts: rows.map((row) => [row.catalogue, row.part]) }, part.beside);
}

/** Another view in place of the list. */
async function turned(job, body, show) {
  const mine = ++requested;
  reading = true;
  try {
    const [piece] = await whole(job, { text: state.text, ...body });
    if (mine === requested) show(found, piece);
  } catch (error) {
    if (mine === requested) list.wrong(found, error);
  }
}

/** The fit of a log in place of the list. */
function fitted(head, body) {
  reading = true;
  requested += 1;
  found.replaceChildren(element("p", {}, button("Back to the list", back)), head, body);
  tabled(found);
  head.focus();
}

function back() {
  reading = false;
  requested += 1;
  list.again(found);
}

/** Puts what was chosen into the spec. */
async function choose(body) {
  try {
    const [{ edits }] = await whole("choose", { text: state.text, ...body });
    dialog.close();
    act(edits);
  } catch (error) {
    list.refused(found, error);
  }
}
