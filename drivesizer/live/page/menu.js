// A list of things to choose from, opened by a button: with arrow keys, letters of a name, Escape.

import { button, element } from "./dom.js";

const panel = element("div", { className: "menu", popover: "auto", role: "dialog" });
const seek = element("input", { type: "text", placeholder: "find …", aria: { label: "find" }, autocomplete: "off", spellcheck: false });
const list = element("div", { className: "choices" });
panel.append(seek, list);
document.body.append(panel);

/** Opens under a button: `choices` are {name, help, does}, or {head} between them. */
export function open(by, label, choices) {
  panel.setAttribute("aria-label", label);
  seek.value = "";
  list.replaceChildren(...choices.map(entry));
  panel.showPopover();
  panel.style.minWidth = `${Math.max(by.offsetWidth, 200)}px`;
  place(by.getBoundingClientRect());
  seek.focus();
}

function entry(choice) {
  if (choice.head) return element("p", { className: "head", textContent: choice.head });
  const made = button("", () => { panel.hidePopover(); choice.does(); }, { className: "choice" });
  made.append(element("span", { textContent: choice.name }));
  if (choice.help) made.append(element("small", { textContent: choice.help }));
  return made;
}

/** Below the button or above it, wherever there is more room, and never beyond the edge. */
function place(around) {
  const { clientWidth: width, clientHeight: height } = document.documentElement;
  const below = height - around.bottom, above = around.top;
  const room = Math.max(below, above) - 16;
  panel.style.maxHeight = `${Math.min(room, 480)}px`;
  const top = below >= Math.min(panel.offsetHeight, 480) + 8 || below >= above ? around.bottom + 4 : around.top - panel.offsetHeight - 4;
  panel.style.top = `${Math.max(8, top)}px`;
  panel.style.left = `${Math.max(8, Math.min(around.left, width - panel.offsetWidth - 8))}px`;
}

seek.addEventListener("input", () => {
  const wanted = seek.value.trim().toLowerCase();
  for (const one of list.querySelectorAll("button")) one.hidden = !one.textContent.toLowerCase().includes(wanted);
  for (const one of list.querySelectorAll(".head")) one.hidden = wanted !== "";
});

panel.addEventListener("keydown", (event) => {
  const all = [seek, ...list.querySelectorAll("button:not([hidden])")], here = all.indexOf(document.activeElement);
  const to = { ArrowDown: here + 1, ArrowUp: here - 1, Home: 1, End: -1 }[event.key];
  if (event.key === "Tab") panel.hidePopover(); // goes on from the opener
  else if (document.activeElement === seek && event.key === "Enter") {
    event.preventDefault();
    all[1]?.click();
  } else if (to !== undefined && !(document.activeElement === seek && /Home|End/.test(event.key))) {
    event.preventDefault();
    all.at(to % all.length).focus();
  } else if (document.activeElement !== seek && event.key.length === 1) seek.focus();
});
