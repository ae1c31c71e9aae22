// Two or more drives side by side.

import { button, element } from "./dom.js";
import { whole } from "./requests.js";
import { state } from "./state.js";

const panel = document.getElementById("compared");
const MOST = 4;
let chosen = []; // {motor, gearhead, label}

const same = (a, b) => a.motor === b.motor && a.gearhead === b.gearhead;
const boxesShown = () => [...document.querySelectorAll("input.compares")];

/** Gives every drive of the table a box by which it is chosen; a machine's drives have none. */
export function boxes(drives) {
  for (const row of document.querySelectorAll("#sets tr[data-rank]")) {
    const one = drives.find((each) => String(each.rank) === row.dataset.rank);
    const cell = row.cells[0];
    if (!one || cell.querySelector("input")) continue;
    cell.prepend(tick(one));
  }
}

/** A box by which a drive is chosen. */
export function tick(one) {
  const box = element("input", { type: "checkbox", className: "compares", checked: chosen.some((each) => same(each, one)), aria: { label: `compare ${one.label}` } });
  box.one = one;
  box.addEventListener("change", () => take(one, box.checked));
  return box;
}

function take(one, wanted) {
  chosen = chosen.filter((each) => !same(each, one));
  if (wanted) chosen = [...chosen, one].slice(-MOST);
  for (const box of boxesShown()) box.checked = chosen.some((each) => same(each, box.one));
  renew(true);
}

/** The comparison for the spec as it is now; shown where it has just been chosen. */
export async function renew(now = false) {
  if (chosen.length < 2) {
    panel.replaceChildren(...(now && chosen.length ? [element("p", { className: "note", textContent: "Choose a second drive to see both side by side." })] : []));
    return;
  }
  const text = state.text;
  try {
    const [found] = await whole("compare", { text, sets: chosen.map((one) => [one.motor, one.gearhead]) });
    if (found?.kind === "compared" && text === state.text) panel.replaceChildren(...drawn(found));
  } catch (error) {
    panel.replaceChildren(element("p", { className: "fault", textContent: `not compared: ${error.message}` }));
  }
}

function drawn(found) {
  const close = button("close", () => {
    const first = boxesShown().find((box) => box.checked);
    chosen = [];
    for (const box of boxesShown()) box.checked = false;
    panel.replaceChildren();
    first?.focus();
  });
  const table = element("div", { innerHTML: found.html }); // of the server's own templates, which escape every text
  const section = element("section", {}, element("div", { className: "head" }, element("h2", { textContent: "Side by side" }), close), table);
  tabled(section);
  return [section];
}
