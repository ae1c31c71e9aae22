// Figures that can be moved, drawn as soon as what draws them is there.

import { plotly } from "./answer.js";
import { element } from "./dom.js";

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
