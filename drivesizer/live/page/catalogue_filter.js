// Which parts are looked for: their kind, conditions on their figures, words, and the catalogues.

import { button, element, words } from "./dom.js";

const WAIT = 250; // ms without a key, after which parts are listed
const SIGNS = ["≥", "≤", "=", ">", "<", "≠"];
const TYPED = { "≥": ">=", "≤": "<=", "≠": "!=" };
const HINTS = { family: "RE 25, EC*", voltage: "24 V, <=48 V", diameter: "<=26 mm", power: ">=20 W", kind: "brushed, planet*" };
const section = element("select", { id: "parts-of" });
const seek = element("input", { type: "search", id: "parts-with", placeholder: "number, family, kind, maker", autocomplete: "off" });
const excluded = element("input", { type: "checkbox", id: "parts-excluded" });
const options = element("div", { className: "options" }), conditions = element("div", { className: "conditions" });
const column = element("select", { aria: { label: "add a condition" } });
const heads = element("summary"), boxes = element("div", { className: "shelf" });
const narrow = matchMedia("(max-width: 62rem)");
let sections = [], shelf = [], touched = false, look = () => {}, wait = 0;

export function build(onLook, own) {
  look = onLook;
  section.addEventListener("change", () => { fields(); look(); });
  seek.addEventListener("input", later);
  excluded.addEventListener("change", () => look());
  column.addEventListener("change", add);
  const sift = element("div", { className: "sift" }, row("parts", section), row("containing", seek), options, conditions, element("p", {}, column),
    element("p", {}, element("label", {}, excluded, " also parts excluded from sizing")));
  const chosen = element("details", { className: "shelves" }, heads, element("p", {}, button("the spec's", () => take((one) => one.chosen)), " ", button("all", () => take(() => true)), " ", button("none", () => take(() => false))), boxes);
  const form = element("form", { autocomplete: "off", noValidate: true }, sift, chosen, own);
  form.addEventListener("submit", (event) => { event.preventDefault(); look(); });
  const box = element("details", { className: "filter", open: !narrow.matches }, element("summary", { textContent: "Filter and catalogues" }), form);
  narrow.addEventListener("change", () => { box.open = !narrow.matches; });
  return box;
}

function row(name, input) {
  return element("div", { className: "field" }, element("label", { htmlFor: input.id, textContent: name }), input);
}

function later() {
  clearTimeout(wait);
  wait = setTimeout(look, WAIT);
}

/** Takes what there is; catalogues that the user has not chosen himself are those of the spec. */
export function show(piece, added) {
  const before = new Set(chosenNames());
  shelf = piece.catalogues;
  if (!sections.length) {
    sections = piece.sections;
    section.replaceChildren(...sections.map((one) => element("option", { value: one.name, textContent: words(one.name) })));
    fields();
  }
  boxes.replaceChildren(...shelf.map((one) => entry(one, touched ? before.has(one.name) || one.name === added : one.chosen || one.name === added)));
  count();
}

/** Parts of each kind in words: 2 motors, 1 battery. */
export function counted(parts) {
  const one = (name) => words(name).replace(/ies$/, "y").replace(/s$/, "");
  return Object.entries(parts).map(([name, number]) => `${number} ${number === 1 ? one(name) : words(name)}`).join(", ");
}

function entry(one, checked) {
  const box = element("input", { type: "checkbox", checked: checked && !one.wrong, value: one.name, disabled: Boolean(one.wrong) });
  box.addEventListener("change", () => { touched = true; count(); look(); });
  const label = element("label", { title: one.wrong ?? counted(one.parts) }, box, ` ${one.own || one.wrong ? one.name : one.makers || one.name}`);
  const made = element("p", {}, label);
  if (one.wrong) made.append(element("span", { className: "error", textContent: one.wrong }));
  return made;
}

function take(wanted) {
  touched = true;
  for (const [n, box] of [...boxes.querySelectorAll("input")].entries()) box.checked = !box.disabled && wanted(shelf[n]);
  count();
  look();
}

const chosenNames = () => [...boxes.querySelectorAll("input:checked")].map((box) => box.value);

function count() {
  const names = chosenNames();
  heads.textContent = `Catalogues: ${names.length === 1 ? names[0] : `${names.length} of ${shelf.length}`}`;
  for (const option of section.options) {
    const parts = shelf.filter((one) => names.includes(one.name)).reduce((sum, one) => sum + (one.parts[option.value] ?? 0), 0);
    option.textContent = `${words(option.value)} (${parts})`;
  }
}

// -- conditions

const here = () => sections.find((one) => one.name === section.value);

/** The fields of a kind of part. */
function fields() {
  const typed = Object.fromEntries([...options.querySelectorAll("input")].map((input) => [input.name, input.value]));
  options.replaceChildren(...here().options.map((name) => {
    const input = element("input", { type: "text", id: `parts-${name}`, name, value: typed[name] ?? "", placeholder: HINTS[name], spellcheck: false, dataset: { field: name } });
    input.addEventListener("input", later);
    return row(words(name), input);
  }));
  conditions.replaceChildren();
  column.replaceChildren(element("option", { value: "", textContent: "add a condition …" }), ...here().columns.map(([name]) => element("option", { value: name, textContent: words(name) })));
}

function add() {
  const [name, shown, unit, text] = here().columns.find(([one]) => one === column.value) ?? [];
  column.value = "";
  if (!name) return;
  const id = `parts-where-${conditions.childElementCount}-${name}`;
  const sign = element("select", { aria: { label: `${words(name)} is` } }, ...(text ? ["=", "≠"] : SIGNS).map((one) => element("option", { value: one, textContent: one })));
  const input = element("input", { type: "text", id, placeholder: text ? "text, * for any" : shown || "number", spellcheck: false, dataset: { unit, name } });
  const gone = button("×", () => { made.remove(); look(); column.focus(); }, { title: `remove the condition on ${words(name)}`, aria: { label: `remove the condition on ${words(name)}` } });
  const made = element("div", { className: "field condition" }, element("label", { htmlFor: id, textContent: words(name) }), element("span", { className: "is" }, sign, input, gone));
  sign.addEventListener("change", () => look());
  input.addEventListener("input", later);
  conditions.append(made);
  input.focus();
}

/** A condition as one types it for the command; a plain number is in the unit of data sheets. */
function typed(made) {
  const [sign] = made.querySelectorAll("select"), [input] = made.querySelectorAll("input");
  const value = input.value.trim(), plain = input.dataset.unit && /^[-+]?[\d.]+(e[-+]?\d+)?$/i.test(value);
  return value ? `${input.dataset.name} ${TYPED[sign.value] ?? sign.value} ${value}${plain ? ` ${input.dataset.unit}` : ""}` : null;
}

const filled = () => [...conditions.children].filter((one) => typed(one) !== null);

export const wanted = () => ({
  section: section.value, catalogues: chosenNames(), piece: seek.value, excluded: excluded.checked, where: filled().map(typed),
  options: Object.fromEntries([...options.querySelectorAll("input")].filter((input) => input.value.trim()).map((input) => [input.name, input.value])),
});

export const kind = () => section.value;

/** Marks the conditions that cannot be read, each with the reason. */
export function faults(list) {
  for (const old of document.querySelectorAll("#browser .sift .error")) old.remove();
  for (const input of document.querySelectorAll("#browser .sift [aria-invalid]")) { input.removeAttribute("aria-invalid"); input.removeAttribute("aria-describedby"); }
  for (const { field, text } of list) {
    const [, number] = field.split(".");
    const made = number === undefined ? options.querySelector(`[name="${CSS.escape(field)}"]`)?.parentElement : filled()[Number(number)];
    const input = made?.querySelector("input");
    if (!input) continue;
    made.append(element("p", { className: "error", id: `${input.id}-error`, textContent: text }));
    input.setAttribute("aria-invalid", "true");
    input.setAttribute("aria-describedby", `${input.id}-error`);
  }
}
