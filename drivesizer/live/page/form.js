// The form: a field for each figure of the spec, out of its schema.

import { branch, chosen, example, isText, resolved, turnedInto } from "./fields.js";

const form = document.getElementById("form");
const added = new Set(); // paths of fields that were added and have no value yet
const closed = new Map(); // groups that the user opened or closed
let act = () => {}; // what is done with edits
let slide = () => {};
let schemas = null;

export function prepare(given, onEdits, onSlide) {
  schemas = given;
  act = onEdits;
  slide = onSlide;
  form.addEventListener("submit", (event) => event.preventDefault());
}

/** Draws the form anew; the field that has the keyboard keeps it, and what is typed in it. */
export function show(data, faults) {
  const active = form.contains(document.activeElement) ? document.activeElement : null;
  const place = active?.dataset.key, typed = active?.value, from = active?.selectionStart;
  const several = data && typeof data === "object" && ("axes" in data || "robot" in data);
  const root = schemas[several ? "machine" : "spec"];
  const context = { root, faults: [...faults] };
  form.replaceChildren(...fieldsOf(root, data ?? {}, [], context));
  if (place === undefined) return;
  const again = form.querySelector(`[data-key="${CSS.escape(place)}"]`);
  if (!again) return;
  if (again.tagName === "INPUT" && document.activeElement !== again) again.value = typed;
  again.focus({ preventScroll: true });
  if (again.type === "text" && from !== null) again.setSelectionRange(from, from);
}

/** Shows a field and gives it the keyboard. */
export function focus(path) {
  for (let length = path.length; length > 0; length -= 1) {
    const found = form.querySelector(`[data-key="${CSS.escape(keyOfPath(path.slice(0, length)))}"]`);
    if (!found) continue;
    for (let group = found.closest("details"); group; group = group.parentElement.closest("details")) group.open = true;
    found.scrollIntoView({ block: "center" });
    found.focus();
    return true;
  }
  return false;
}

const keyOfPath = (path) => path.join("\u001f");
const PLAIN = / with unit$|^a plain number or percent$/; // says what the value says itself
const words = (name) => String(name).replaceAll("_", " ");

function element(tag, properties = {}, ...children) {
  const made = Object.assign(document.createElement(tag), properties);
  made.append(...children);
  return made;
}

/** Fields of a group that are given or required, and a list of those that may be added. */
function fieldsOf(schema, value, path, context, but) {
  const known = Object.keys(schema.properties ?? {});
  const given = value && typeof value === "object" ? Object.keys(value) : [];
  const free = schema.additionalProperties && typeof schema.additionalProperties === "object" ? given.filter((one) => !known.includes(one)) : [];
  const required = new Set(schema.required ?? []);
  const shown = known.filter((one) => one !== but && (given.includes(one) || required.has(one) || added.has(keyOfPath([...path, one]))));
  const made = [...shown, ...free].map((one) => field(schema.properties?.[one] ?? schema.additionalProperties, value?.[one], [...path, one], context, required.has(one)));
  const rest = known.filter((one) => one !== but && !shown.includes(one));
  if (rest.length) made.push(adder(schema, rest, path, context));
  return made;
}

function adder(schema, names, path, context) {
  const list = element("select", { ariaLabel: `add a field${path.length ? ` to ${words(path.at(-1))}` : ""}` }, element("option", { value: "", textContent: path.length ? "add a field …" : "add a section …" }));
  for (const name of names) list.append(element("option", { value: name, textContent: words(name), title: resolved(schema.properties[name], context.root).description ?? "" }));
  list.dataset.key = keyOfPath([...path, "+"]);
  list.addEventListener("change", () => {
    const name = list.value, place = [...path, name];
    const found = branch(schema.properties[name], undefined, context.root);
    const compound = found.discriminator || found.properties || found.type === "array";
    if (compound && Object.keys(found.properties ?? {}).length && !(found.required ?? []).length) {
      added.add(keyOfPath(place)); // a group without a field that it must have begins empty
      closed.set(keyOfPath(place), true);
      act([]);
    } else if (compound || found.enum || found.type === "boolean") {
      act([[place, example(schema.properties[name], context.root), isText(found)]]);
    } else {
      added.add(keyOfPath(place));
      act([]);
    }
    requestAnimationFrame(() => focus(place));
  });
  return element("p", { className: "add" }, list);
}

function field(schema, value, path, context, required) {
  const found = branch(schema, value, context.root);
  if (found.discriminator) return kinds(found, value, path, context, required);
  if (found.type === "array" && (value === undefined || Array.isArray(value))) return list(found, value ?? [], path, context, required);
  const groups = found.properties || (found.additionalProperties && typeof found.additionalProperties === "object");
  if (groups && (value === undefined || value === null || typeof value === "object")) {
    return group(path, fieldsOf(found, value, path, context), found, value, context, required);
  }
  return single(found, value, path, context, required);
}

/** A group that may be of several kinds. */
function kinds(schema, value, path, context, required) {
  const { key, names, name, group: own } = chosen(schema, value, context.root);
  const pick = element("select", {}, ...names.map((one) => element("option", { value: one, textContent: words(one), selected: one === name })));
  const line = row(pick, key, [...path, key], { description: own.description }, context);
  pick.addEventListener("change", () => act(turnedInto(path, schema, value, pick.value, context.root)));
  return group(path, [line, ...fieldsOf(own, value, path, context, key)], schema, value, context, required);
}

function group(path, inside, schema, value, context, required) {
  const key = keyOfPath(path);
  const wrong = context.faults.some((one) => path.every((step, n) => one.path[n] === step));
  const given = value !== undefined && value !== null;
  const made = element("details", { open: wrong || (closed.get(key) ?? (given || added.has(key)) ) });
  made.addEventListener("toggle", () => closed.set(key, made.open));
  const summary = element("summary", {}, words(typeof path.at(-1) === "number" ? `${path.at(-1) + 1}` : path.at(-1)));
  if (schema.title !== undefined && schema.description) summary.title = schema.description;
  const body = element("div", { className: "group" }, ...inside);
  if (given && !required) body.append(element("p", { className: "add" }, remover(path)));
  made.append(summary, body);
  return made;
}

function remover(path) {
  const made = element("button", { type: "button", textContent: "remove", ariaLabel: `remove ${words(path.at(-1))}` });
  made.dataset.key = keyOfPath([...path, "-"]);
  made.addEventListener("click", () => { added.delete(keyOfPath(path)); act([[path, null, false]]); });
  return made;
}

function list(schema, value, path, context, required) {
  const inside = value.map((one, n) => {
    const item = field(schema.items, one, [...path, n], context, false);
    return item;
  });
  const more = element("button", { type: "button", textContent: `add ${value.length ? "another" : "one"}` });
  more.dataset.key = keyOfPath([...path, "+"]);
  more.addEventListener("click", () => act([[[...path, value.length], example(schema.items, context.root), isText(resolved(schema.items, context.root))]]));
  return group(path, [...inside, element("p", { className: "add" }, more)], schema, value.length ? value : undefined, context, required);
}

function single(schema, value, path, context, required) {
  const plain = value === undefined || value === null ? "" : typeof value === "object" ? JSON.stringify(value) : String(value);
  let input;
  if (schema.enum || schema.type === "boolean" || schema.const !== undefined) {
    const options = schema.enum ?? (schema.type === "boolean" ? [true, false] : [schema.const]);
    input = element("select", {}, ...options.map((one) => element("option", { value: String(one), textContent: one === true ? "yes" : one === false ? "no" : words(one), selected: String(one) === (plain || String(schema.default ?? options[0])) })));
    input.addEventListener("change", () => act([[path, schema.type === "boolean" ? input.value === "true" : input.value, isText(schema)]]));
  } else {
    input = element("input", { type: "text", value: plain, placeholder: hint(schema, required) });
    input.addEventListener("change", () => {
      const text = input.value.trim();
      added.delete(keyOfPath(path));
      if (text === plain) return;
      act([[path, text === "" ? null : text, isText(schema)]]);
    });
  }
  return row(input, path.at(-1), path, schema, context, { value: plain, required });
}

function hint(schema, required) {
  if (schema.default !== undefined && schema.default !== null) return String(schema.default);
  return schema.examples?.length ? `e.g. ${schema.examples[0]}` : required ? "required" : "";
}

/** A label, the input, its help, what is wrong with it, and what else may be done with it. */
function row(input, name, path, schema, context, { value = "", required = true } = {}) {
  const key = keyOfPath(path), id = `f-${[...key].map((one) => one.codePointAt(0).toString(36)).join("")}`;
  input.id = id;
  input.dataset.key = key;
  const label = element("label", { htmlFor: id, textContent: words(typeof name === "number" ? `${name + 1}` : name) });
  const made = element("div", { className: "field" }, label, input);
  const beside = element("span", { className: "beside" });
  if (/^[-+]?\d/.test(value) && input.tagName === "INPUT") beside.append(slider(path, value));
  if (value !== "" && !required) beside.append(small("×", `remove ${words(name)}`, () => act([[path, null, false]]), [...path, "-"]));
  made.append(beside);
  describe(made, input, schema.description, context.faults.filter((one) => keyOfPath(one.path) === key));
  return made;
}

function describe(made, input, description, wrong) {
  const ids = [];
  if (description && !PLAIN.test(description)) {
    const help = element("p", { className: "help", id: `${input.id}-help`, textContent: description });
    made.append(help);
    ids.push(help.id);
  }
  for (const [n, one] of wrong.entries()) {
    const error = element("p", { className: "error", id: `${input.id}-error${n}`, textContent: one.text });
    made.append(error);
    ids.push(error.id);
    input.setAttribute("aria-invalid", "true");
  }
  if (ids.length) input.setAttribute("aria-describedby", ids.join(" "));
}

function slider(path, value) {
  return small("⇔", `slider for ${words(path.filter((step) => typeof step === "string").join(" "))}`, () => slide(path, value), [...path, "~"]);
}

function small(text, label, does, path) {
  const made = element("button", { type: "button", textContent: text, title: label });
  made.setAttribute("aria-label", label);
  made.dataset.key = keyOfPath(path);
  made.addEventListener("click", does);
  return made;
}
