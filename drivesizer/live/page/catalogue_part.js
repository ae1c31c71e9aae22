// One part as a data sheet with its curves, and parts side by side.

import { button, element } from "./dom.js";
import { drawn } from "./figure.js";
import { state } from "./state.js";

let act = {};

/** `choose` puts a part into the spec, `back` leads to the list. */
export function prepare(does) { act = does; }

export function show(place, piece) {
  const head = element("h3", { tabIndex: -1 }, `${piece.head} `, element("strong", { textContent: piece.part }));
  const below = element("p", { className: "note", textContent: `${piece.role} in ${piece.catalogue}` });
  const sheet = element("div", {}), does = element("div", {}); // of the server's own templates, which escape every text
  sheet.innerHTML = piece.sheet;
  does.innerHTML = piece.does;
  sheet.append(sources(piece.documents));
  place.replaceChildren(element("p", {}, button("Back to the list", act.back)), head, below, uses(piece), element("div", { className: "sheets" }, sheet, does));
  tabled(place);
  head.focus();
  drawn(does, piece.figures);
}

/** Buttons that put it into the spec. */
function uses(piece) {
  if (!piece.use) return "";
  const axes = piece.use.axes ? Object.keys(state.data?.axes ?? {}) : [];
  const axis = element("select", { aria: { label: "for which axis" } }, element("option", { value: "", textContent: "all axes" }), ...axes.map((name) => element("option", { value: name, textContent: name })));
  const does = (family) => () => act.choose({ part: [piece.catalogue, piece.section, piece.part], family, axis: axis.value });
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

export function beside(place, piece) {
  const head = element("h3", { tabIndex: -1, textContent: "Side by side" }), made = element("div", {});
  made.innerHTML = piece.html; // of the server's own templates
  place.replaceChildren(element("p", {}, button("Back to the list", act.back)), head, made);
  tabled(place);
  head.focus();
}
