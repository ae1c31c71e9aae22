// Two or more drives side by side.

import { whole } from "./requests.js";
import { state } from "./state.js";

const panel = document.getElementById("compared");
const MOST = 4;
let chosen = []; // {motor, gearhead, label}
let listed = [];

function element(tag, properties = {}, ...children) {
  const made = Object.assign(document.createElement(tag), properties);
  made.append(...children);
  return made;
}

const keyOf = (one) => `${one.motor} ${one.gearhead}`;

export function rank(piece) {
  listed = piece.sets;
}

/** Gives every drive of the table a box by which it is chosen. */
export function boxes() {
  for (const row of document.querySelectorAll("#sets tr[data-rank]")) {
    const one = listed.find((each) => String(each.rank) === row.dataset.rank);
    const cell = row.cells[0];
    if (!one || cell.querySelector("input")) continue;
    const box = element("input", { type: "checkbox", checked: chosen.some((each) => keyOf(each) === keyOf(one)) });
    box.setAttribute("aria-label", `compare ${one.label}`);
    box.addEventListener("change", () => take(one, box.checked));
    cell.prepend(box);
  }
}

function take(one, wanted) {
  chosen = chosen.filter((each) => keyOf(each) !== keyOf(one));
  if (wanted) chosen = [...chosen, one].slice(-MOST);
  for (const box of document.querySelectorAll("#sets input")) box.remove();
  boxes();
  renew();
}

/** The comparison for the spec as it is now. */
export async function renew() {
  if (chosen.length < 2) {
    panel.replaceChildren();
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
  const close = element("button", { type: "button", textContent: "close" });
  close.addEventListener("click", () => { chosen = []; for (const box of document.querySelectorAll("#sets input")) box.checked = false; panel.replaceChildren(); });
  const heads = found.heads.map((head, n) => element("th", { scope: "col" }, head, " ", element("span", { className: `pill ${found.status[n]}`, textContent: found.status[n] })));
  const table = element("table", { className: "compared" }, element("caption", { textContent: "Margins are of each drive's worst case." }), element("thead", {}, element("tr", {}, element("th", { scope: "col" }), ...heads)), element("tbody", {}, ...rows(found)));
  const box = element("div", { className: "scroll", tabIndex: 0, role: "region", ariaLabel: "drives side by side" }, table);
  const head = element("div", { className: "head" }, element("h2", { textContent: "Side by side" }), close);
  const whole = element("section", {}, head, element("div", { className: "framed" }, box));
  tabled(whole);
  return [whole];
}

function rows(found) {
  const made = [];
  let group = "";
  for (const row of found.rows) {
    if (row.group !== group) {
      group = row.group;
      made.push(element("tr", { className: "part" }, element("th", { colSpan: found.heads.length + 1, scope: "colgroup", textContent: group })));
    }
    const cells = row.cells.map((cell, n) => element("td", {}, row.status?.[n] === "fail" ? element("span", { className: "pill fail", textContent: cell || "fail" }) : cell));
    made.push(element("tr", {}, element("th", { scope: "row", textContent: row.title }), ...cells));
  }
  return made;
}
