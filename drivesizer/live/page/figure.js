// A figure that can be moved, with its legend, out of plain data: nothing of it is read as markup.

import { plotly } from "./answer.js";
import { button, element } from "./dom.js";

const SVG = "http://www.w3.org/2000/svg";
const MARKS = { circle: "M15 2a4 4 0 1 0 .01 0z", square: "M11 2h8v8h-8z" };

export function drawing(name, plot) {
  const keys = `${plot.title}. Arrow keys go from point to point and from line to line, + and − zoom, 0 shows all.`;
  const place = element("div", { className: "drawing", tabIndex: 0, role: "application", dataset: { plot: name }, aria: { label: keys } });
  place.style.height = `${plot.layout.height}px`;
  const legend = element("div", { className: "legend", role: "group", aria: { label: "lines that are shown" } }, ...plot.legend.map(entry));
  return element("figure", { className: "plot" }, element("p", { className: "over", textContent: plot.title }), element("div", { className: "controls" }, legend), place);
}

function entry(item) {
  const made = button("", () => {}, { aria: { pressed: String(item.shown) }, dataset: { traces: JSON.stringify(item.traces) } });
  made.append(swatch(item), element("span", { textContent: item.label }));
  return made;
}

function shape(tag, properties) {
  const made = document.createElementNS(SVG, tag);
  for (const [name, value] of Object.entries(properties)) made.setAttribute(name, value);
  return made;
}

/** A line, an area or a mark as it is drawn. */
function swatch(item) {
  const made = shape("svg", { viewBox: "0 0 30 12", "aria-hidden": "true", class: item.colour });
  if (item.filled) made.append(shape("rect", { x: 1, y: 1, width: 28, height: 10, class: "area" }));
  else if (item.mark) made.append(shape("path", { d: MARKS[item.mark.replace("-open", "")] ?? MARKS.circle, class: item.mark.includes("open") ? "hollow" : "dot" }));
  else made.append(shape("line", { x1: 0, y1: 6, x2: 30, y2: 6, ...(item.dash === "solid" ? {} : { "stroke-dasharray": item.dash.replaceAll("px", "") }) }));
  return made;
}

/** Draws the figures of a place, as soon as what draws them is there. */
export async function drawn(root, plots) {
  const places = [...root.querySelectorAll(".drawing")];
  if (!places.length) return;
  try {
    await plotly();
  } catch {
    for (const place of places) place.replaceChildren(element("p", { className: "wanting", textContent: "not drawn: the server does not answer" }));
    return;
  }
  for (const place of places) if (place.isConnected) await draw(place, plots[place.dataset.plot]);
}

matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => redress([...document.querySelectorAll("#browser .drawing")], false));
