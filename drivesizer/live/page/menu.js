// A list of things to choose from, opened by a button: with arrow keys, the first letters of a name, Escape.

import { button, element } from "./dom.js";

const panel = element("div", { className: "menu", popover: "auto", role: "dialog" });
const seek = element("input", { type: "text", placeholder: "find …", aria: { label: "find" }, autocomplete: "off", spellcheck: false });
const list = element("div", { className: "choices" });
const FEW = 8; // choices without a field to find them by
let opener = null;
panel.append(seek, list);
document.body.append(panel);

/** Opens under a button: `choices` are {name, help, does}, or {head} between them. */
export function open(by, label, choices) {
  opener = by;
  panel.setAttribute("aria-label", label);
  seek.value = "";
  seek.hidden = choices.length <= FEW;
  list.replaceChildren(...choices.map(entry));
  panel.showPopover();
  panel.style.minWidth = `${Math.max(by.offsetWidth, 200)}px`;
  place(by.getBoundingClientRect());
  (seek.hidden ? list.querySelector("button") : seek).focus();
}

function entry(choice) {
  if (choice.head) return element("p", { className: "head", textContent: choice.head });
  const made = button("", () => { close(); choice.does(); }, { className: "choice" });
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

function close() {
  panel.hidePopover();
  if (opener?.isConnected) opener.focus({ preventScroll: true });
}

const shown = () => [...list.querySelectorAll("button")].filter((one) => !one.hidden);

seek.addEventListener("input", () => {
  const wanted = seek.value.trim().toLowerCase();
  for (const one of list.querySelectorAll("button")) one.hidden = !one.textContent.toLowerCase().includes(wanted);
  for (const one of list.querySelectorAll(".head")) one.hidden = wanted !== "";
});

panel.addEventListener("keydown", (event) => {
  const all = shown(), here = all.indexOf(document.activeElement);
  const to = { ArrowDown: here + 1, ArrowUp: here - 1, Home: here < 0 ? null : 0, End: here < 0 ? null : all.length - 1 }[event.key];
  if (event.key === "Enter" && document.activeElement === seek) {
    event.preventDefault();
    all[0]?.click();
  } else if (to !== undefined && to !== null) {
    event.preventDefault();
    (to < 0 && !seek.hidden ? seek : all[(to + all.length) % Math.max(all.length, 1)])?.focus();
  } else if (event.key === "Tab") close();
  else if (event.key === "Escape") { event.preventDefault(); close(); }
  else if (seek.hidden && event.key.length === 1) startingWith(event.key.toLowerCase(), all, here);
});

function startingWith(letter, all, here) {
  const order = [...all.slice(here + 1), ...all.slice(0, here + 1)];
  order.find((one) => one.textContent.toLowerCase().startsWith(letter))?.focus();
}
