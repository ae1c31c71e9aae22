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
  panel.showPopover({ source: by }); // below or above it, as the stylesheet says
  seek.focus();
}

function entry(choice) {
  if (choice.head) return element("p", { className: "head", textContent: choice.head });
  const made = button("", () => { panel.hidePopover(); choice.does(); }, { className: "choice" });
  made.append(element("span", { textContent: choice.name }));
  if (choice.help) made.append(element("small", { textContent: choice.help }));
  return made;
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
