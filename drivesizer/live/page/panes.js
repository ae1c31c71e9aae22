// Which part of the page is in sight: the machine as form or YAML, and on a narrow screen the machine or its answer.

import * as form from "./form.js";
import { state } from "./state.js";

const area = document.getElementById("text");
const tabs = [...document.querySelectorAll('[role="tab"]')];
const switches = [...document.querySelectorAll("#switch button")];

/** The machine as `form` or `yaml`. */
export function choose(name) {
  document.body.dataset.machine = name;
  for (const tab of tabs) {
    const here = tab.id === `tab-${name}`;
    tab.setAttribute("aria-selected", here);
    tab.tabIndex = here ? 0 : -1;
    document.getElementById(tab.getAttribute("aria-controls")).hidden = !here;
  }
}

/** On a narrow screen: `machine` or `answer`. */
export function turn(name) {
  document.body.dataset.pane = name;
  for (const one of switches) one.setAttribute("aria-pressed", one.dataset.pane === name);
  dispatchEvent(new Event("resize")); // for figures that were drawn for another width
}

/** Shows the field of a fault, or its line. */
export function reveal(fault) {
  turn("machine");
  const fields = document.getElementById("form");
  if (!fields.hidden && !fields.inert && form.focus(fault.path)) return;
  choose("yaml");
  const lines = area.value.split("\n"), number = Math.min(fault.line ?? 1, lines.length);
  const start = lines.slice(0, number - 1).reduce((sum, line) => sum + line.length + 1, 0);
  area.focus();
  area.setSelectionRange(start, start + lines[number - 1].length);
  area.scrollTop = Math.max(0, (number - 4) * parseFloat(getComputedStyle(area).lineHeight));
}

for (const tab of tabs) {
  tab.addEventListener("click", () => {
    choose(tab.id.slice(4));
    if (tab.id === "tab-yaml" && state.faults[0]?.line) reveal(state.faults[0]);
  });
  tab.addEventListener("keydown", (event) => {
    if (event.key !== "ArrowLeft" && event.key !== "ArrowRight") return;
    const other = tab.id === "tab-form" ? "yaml" : "form";
    choose(other);
    document.getElementById(`tab-${other}`).focus();
  });
}
for (const one of switches) {
  one.addEventListener("click", () => { turn(one.dataset.pane); scrollTo({ top: document.getElementById("front").offsetTop }); });
}
document.querySelector(".skip").addEventListener("click", () => turn("answer"));

/** Height of what stays at the top, so that nothing that is scrolled to lies below it. */
const head = document.getElementById("top"), front = document.getElementById("front");
new ResizeObserver(() => {
  const narrow = getComputedStyle(head).display === "contents", stays = narrow ? front : head;
  const height = getComputedStyle(stays).position === "sticky" ? stays.offsetHeight : 0;
  document.documentElement.style.setProperty("--top", `${height}px`);
}).observe(front);
turn("machine");
choose("form");
