// One part as a data sheet with its curves, and parts side by side.

import { button, element, words } from "./dom.js";
import { drawing, drawn } from "./figure.js";
import { state } from "./state.js";

const ROLES = { motors: "motor", actuators: "motor", steppers: "motor", gearheads: "gearhead", encoders: "encoder", controllers: "controller", brakes: "brake", screws: "screw", batteries: "battery", power_supplies: "supply", brake_resistors: "brake resistor" };
const ALONE = ["batteries", "power_supplies"]; // of which a spec names no family
const WHOLE = ["batteries", "power_supplies", "brake_resistors"]; // one for all axes
let act = {};

/** `choose` puts a part into the spec, `back` leads to the list. */
export function prepare(does) { act = does; }

export function show(place, piece) {
  const head = element("h3", { tabIndex: -1 }, `${piece.head} `, element("strong", { textContent: piece.part }));
  const below = element("p", { className: "note", textContent: `${piece.role} in ${piece.catalogue}` });
  const figures = element("div", { className: "curves" }, ...Object.entries(piece.figures).map(([name, plot]) => drawing(name, plot)));
  const side = element("div", {}, figures, ...piece.tables.map(plain));
  const sheet = element("div", {}, figuresOf(piece), ...piece.remarks.map((text) => element("p", { className: "note", textContent: text })), sources(piece.documents));
  place.replaceChildren(element("p", {}, button("Back to the list", act.back)), head, below, uses(piece), element("div", { className: "sheets" }, sheet, side));
  tabled(place);
  head.focus();
  drawn(figures, piece.figures);
}

/** Buttons that put it into the spec. */
function uses(piece) {
  const role = ROLES[piece.section];
  if (!role) return "";
  const axes = WHOLE.includes(piece.section) ? [] : Object.keys(state.data?.axes ?? {});
  const axis = element("select", { aria: { label: "for which axis" } }, element("option", { value: "", textContent: "all axes" }), ...axes.map((name) => element("option", { value: name, textContent: name })));
  const does = (family) => () => act.choose({ part: [piece.catalogue, piece.section, piece.part], family, axis: axis.value });
  const made = element("p", { className: "uses" }, button("Use this part", does(false)));
  if (!ALONE.includes(piece.section) && piece.family) made.append(button(`Only this family, ${piece.family}`, does(true)));
  if (axes.length > 1) made.append(axis);
  return made;
}

function figuresOf(piece) {
  const rows = piece.rows.map(([name, text, confidence, place]) => element("tr", {}, element("th", { scope: "row", textContent: name }), element("td", { className: "n", textContent: text }),
    element("td", {}, confidence === "quoted" ? confidence : element("span", { className: "mark", textContent: confidence })), element("td", { className: "n", textContent: `[${place}]` })));
  const head = element("tr", {}, ...["figure", "", "confidence", "source"].map((text, n) => element("th", { scope: "col", className: n % 2 ? "n" : "", textContent: text })));
  return framed("figures", element("table", { className: "figures" }, element("thead", {}, head), element("tbody", {}, ...rows)));
}

function framed(name, table) {
  return element("div", { className: "framed" }, element("div", { className: "scroll", tabIndex: 0, role: "region", aria: { label: name } }, table));
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

/** A table as the terminal prints it. */
function plain(given) {
  const closing = given.closing ? element("p", { className: "note", textContent: given.closing }) : "";
  if (!given.rows.length) return closing;
  const side = (n) => (given.heads[n]?.[1] === "right" ? "n" : "");
  const head = element("tr", {}, ...given.heads.map(([text], n) => element("th", { scope: "col", className: side(n), textContent: text })));
  const rows = given.rows.map((row) => element("tr", {}, ...row.map((text, n) => element(n ? "td" : "th", { className: side(n), textContent: text, ...(n ? {} : { scope: "row" }) }))));
  const table = element("table", { className: "figures" }, element("thead", {}, head), element("tbody", {}, ...rows));
  if (given.title) table.prepend(element("caption", { textContent: given.title }));
  return element("div", {}, framed(given.title || given.heads[0][0], table), closing);
}

// -- side by side

export function beside(place, piece) {
  const head = element("h3", { tabIndex: -1, textContent: "Side by side" });
  const heads = piece.heads.map(([part, catalogue]) => element("th", { scope: "col", className: "n" }, part, element("small", { textContent: catalogue })));
  const rows = piece.rows.map(([name, mark, cells]) => element("tr", { className: mark === "≠" ? "differs" : "" }, element("td", { textContent: mark }), element("th", { scope: "row", textContent: words(name) }), ...cells.map((text) => element("td", { className: "n", textContent: text }))));
  const empty = (text) => element("th", { scope: "col" }, element("span", { className: "hidden", textContent: text }));
  const table = element("table", { className: "beside" }, element("thead", {}, element("tr", {}, empty("differs"), empty("figure"), ...heads)), element("tbody", {}, ...rows));
  place.replaceChildren(element("p", {}, button("Back to the list", act.back)), head, framed("parts side by side", table), element("p", { className: "note", textContent: piece.closing }));
  tabled(place);
  head.focus();
}
