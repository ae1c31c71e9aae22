// The best drive over the figures of two sliders: a small map, computed where the user wants it.

import { button, element, words } from "./dom.js";
import { pieces, whenFree } from "./requests.js";
import { state } from "./state.js";
import { best, colour, passes } from "./stretches.js";
import * as sweeps from "./sweeps.js";

const CELLS = 7; // along each side
const panel = document.getElementById("sliders");
const wanted = button("map over both sliders", draw, { hidden: true }), place = element("div", { className: "map", hidden: true });
let running = null;
panel.append(wanted, place);
whenFree(() => running?.abort(), () => {});

/** The button is there while two sliders are; a map of another spec goes. */
export function renew() {
  const open = state.sliders.filter((one) => !one.box.hidden);
  wanted.hidden = open.length !== 2;
  panel.append(wanted, place);
  if (place.of !== JSON.stringify([open.map(({ path, low, high }) => [path, low, high]), state.text])) place.hidden = true;
}

const values = (one) => Array.from({ length: CELLS }, (_, n) => {
  const value = one.low + (n / (CELLS - 1)) * (one.high - one.low);
  return one.text(one.whole ? Math.round(value) : Number(value.toPrecision(4)));
});

async function draw() {
  const [across, up] = state.sliders.filter((one) => !one.box.hidden), text = state.text;
  running?.abort();
  running = new AbortController();
  const [columns, rows] = [values(across), values(up).reverse()];
  place.of = JSON.stringify([[across, up].map(({ path, low, high }) => [path, low, high]), text]);
  const cells = rows.map(() => columns.map(() => element("i", { className: "wait" }))), legend = element("ul", { className: "legend" });
  const named = (one, all) => element("p", { className: "ends", textContent: `${one.path.map(words).join(" · ")}: ${all[0]} to ${all.at(-1)}` });
  place.replaceChildren(named(up, [...rows].reverse()), element("div", { className: "cells" }, ...cells.flat()), named(across, columns), legend);
  place.hidden = false;
  sweeps.pause(); // a tab's sweeps take the place of one another
  try {
    for (const [n, row] of rows.entries()) {
      for await (const piece of pieces("sweep", { text, edits: [[up.path, row, false]], path: across.path, values: columns }, running.signal)) {
        if (piece.kind === "point") fill(cells[n][piece.number], piece, `${columns[piece.number]}, ${row}`, legend);
      }
    }
  } catch (error) {
    if (error.name !== "AbortError") legend.append(element("li", { textContent: "not computed: the server does not answer" }));
  } finally {
    sweeps.goOn();
  }
}

function fill(cell, point, where, legend) {
  cell.className = colour(point);
  cell.title = `${where}: ${best(point)}`;
  if ([...legend.children].some((one) => one.dataset.label === point.label)) return;
  const name = passes(point) ? point.name ?? point.label : "none";
  legend.append(element("li", { dataset: { label: point.label } }, element("i", { className: colour(point) }), ` ${name}`));
}
