// The form: a field for each figure of the spec, out of its schema.

import { button, element, keyOf, words } from "./dom.js";
import * as fields from "./fields.js";
import { branch, chosen, example, isFigure, isOpen, isText, read, resolved, turnedInto, written } from "./fields.js";
import { open as openMenu } from "./menu.js";

const form = document.getElementById("form");
const OPEN = new Set(["load", "motion", "transmission", "supply", "axes", "robot"]); // sections that are open at first
// what moves and how, what from, what with; the rest in the order of the schema, and load cases and reports last
const FIRST = ["name", "load", "platform", "motion", "once", "mission", "axes", "robot", "supply", "battery", "brake_resistor", "environment", "needs", "transmission", "select"];
const LAST = ["cases", "tolerances", "design", "report"];
const SHORT = 3; // items of a list that are open at first
const added = new Set(); // paths of fields that were added and have no value yet
const opened = new Map(); // groups that the user opened or closed
let wantedFocus = null; // the field that is to have the keyboard when it has come
let context = null; // of the form as it is drawn
let drawn = ""; // what is shown
const resting = new Map(); // the motion that a load had along a line, and about an axis

/** Takes the schemas, and what is done with edits and for sliders. */
export function prepare(schemas, act, slide) {
  drawn = "";
  context = { schemas, act, slide };
  form.addEventListener("submit", (event) => event.preventDefault());
  for (const name of ["keydown", "pointerdown"]) addEventListener(name, () => { wantedFocus = null; }, true);
}

/** Draws the form anew where it changes; the field that has the keyboard keeps it, and what is typed in it. */
export function show(data, faults) {
  const now = JSON.stringify([data, faults, [...added]]);
  if (now === drawn) return;
  drawn = now;
  const several = data && typeof data === "object" && ("axes" in data || "robot" in data);
  Object.assign(context, { root: context.schemas[several ? "machine" : "spec"], data: data ?? {}, faults: faults.map((one) => ({ ...one })), count: 0 });
  const inside = fieldsOf(context.root, context.data, []);
  keepingFocus(() => form.replaceChildren(...elsewhere([]), ...inside));
}

/** Forgets fields that were added and groups that were opened: another spec follows. */
export function forget() {
  added.clear();
  opened.clear();
  resting.clear();
  fields.forget();
}

/** Whether the form can be used: not beside a text that cannot be read. */
export function use(able) { form.inert = !able; }

/** What is wrong at a place and has no field there. */
function elsewhere(path) {
  const here = context.faults.filter((one) => !one.shown && one.path.length && path.every((step, n) => one.path[n] === step));
  return here.map((one) => {
    one.shown = true;
    return element("p", { className: "error", textContent: one.path.length > path.length ? `${one.path.slice(path.length).map(words).join(" · ")}: ${one.text}` : one.text });
  });
}

/** Fields of a group that are given or required, and a button for those that may be added. */
function fieldsOf(schema, value, path, but, removable = false) {
  const known = ordered(Object.keys(schema.properties ?? {})), given = value && typeof value === "object" ? Object.keys(value) : [];
  const required = new Set(schema.required ?? []);
  const shown = known.filter((one) => one !== but && (given.includes(one) || required.has(one) || added.has(keyOf([...path, one]))));
  const further = given.filter((one) => one !== but && !known.includes(one));
  const made = [...shown, ...further].map((one) => field(schema.properties?.[one] ?? schema.additionalProperties ?? {}, value?.[one], [...path, one], required.has(one)));
  const rest = known.filter((one) => one !== but && !shown.includes(one));
  const tools = [];
  if (rest.length) tools.push(adder(schema, rest, path));
  if (schema.additionalProperties && typeof schema.additionalProperties === "object") tools.push(namer(schema, value ?? {}, path));
  if (removable) tools.push(remover(path));
  if (tools.length) made.push(element("p", { className: "add" }, ...tools));
  return made;
}

function ordered(names) {
  const place = (name) => FIRST.indexOf(name) + 1 || FIRST.length + 1 + (LAST.indexOf(name) + 1);
  return names.includes("load") || names.includes("axes") ? names.sort((a, b) => place(a) - place(b)) : names;
}

function adder(schema, names, path) {
  const label = path.length ? "add a field" : "add a section";
  const made = button(`${label} …`, () => openMenu(made, label, names.map(choice)), { dataset: { key: keyOf([...path, "+"]) }, aria: { haspopup: "dialog" } });
  if (path.length) made.setAttribute("aria-label", `add a field to ${path.map(words).join(" ")}`);
  const choice = (name) => ({ name: words(name), help: resolved(schema.properties[name], context.root).description?.split("\n\n")[0], does: () => add(schema, path, name) });
  return made;
}

/** A field without a value is shown empty; one of several choices, or a group, begins with an example. */
function add(schema, path, name) {
  fields.moving(axisOf(path));
  const place = [...path, name], found = branch(substituted(schema.properties[name], place), undefined, context.root);
  const compound = found.kinds || found.properties || found.type === "array";
  opened.set(keyOf(place), true);
  focusNext(place);
  if ((compound && !isEmpty(found)) || found.enum || found.type === "boolean") {
    context.act([[place, example(found, context.root), isText(found)]]);
  } else {
    added.add(keyOf(place));
    context.act([]);
  }
}

const isEmpty = (found) => found.properties && !found.kinds && !(found.required ?? []).length;

/** Adds an entry of a group whose names are the user's own: a copy of the last one. */
function namer(schema, value, path) {
  const name = element("input", { type: "text", placeholder: "name", autocomplete: "off", spellcheck: false, aria: { label: `name of another of ${words(path.at(-1))}` }, dataset: { key: keyOf([...path, "name"]) } });
  const made = button("add", () => {
    const wanted = name.value.trim();
    if (!wanted || wanted in value) return name.focus();
    opened.set(keyOf([...path, wanted]), true);
    focusNext([...path, wanted]);
    return context.act([[[...path, wanted], Object.values(value).at(-1) ?? example(schema.additionalProperties, context.root), false]]);
  }, { dataset: { key: keyOf([...path, "+name"]) }, aria: { label: `add another of ${words(path.at(-1))}` } });
  return element("span", { className: "namer" }, name, made);
}

/** A load case says what differs from a section of the spec: its fields are those of that section, none required. */
function substituted(schema, path) {
  if (path.at(-3) !== "cases" || schema.additionalProperties !== true) return schema;
  const section = path.at(-1), own = at([...path.slice(0, -3), section]);
  const found = branch(context.root.properties[section], own ?? context.data[section], context.root);
  const group = found.kinds ? chosen(found, own ?? context.data[section]).group : found;
  return { ...group, required: [], kinds: undefined };
}

function field(given, value, path, required) {
  const open = isOpen(value), schema = substituted(given, path), found = branch(schema, open ? undefined : value, context.root);
  if (open) return single(found, value, path, required);
  const grouped = value === undefined || value === null || (typeof value === "object" && !Array.isArray(value));
  if (found.kinds && grouped) return kinds(found, value, path, required);
  if (found.type === "array" && (value === undefined || Array.isArray(value))) return list(found, value ?? [], path, required);
  if (grouped && (found.properties || (found.additionalProperties && typeof found.additionalProperties === "object"))) {
    return group(path, fieldsOf(found, value, path, undefined, removable(value, path, required)), found, value);
  }
  return single(found, value, path, required);
}

/** A group that may be of several kinds. */
function kinds(schema, value, path, required) {
  const { key, names, name, group: own } = chosen(schema, value);
  const pick = element("select", {}, ...names.map((one) => element("option", { value: one, textContent: words(one), selected: one === name })));
  if (value?.[key] !== undefined && !names.includes(value[key])) pick.prepend(element("option", { value: "", textContent: String(value[key]), selected: true }));
  pick.addEventListener("change", () => context.act(turned(path, schema, value, pick.value)));
  const line = row(pick, [...path, key], own.description);
  return group(path, [line, ...fieldsOf(own, value, path, key, removable(value, path, required))], schema, value);
}

const removable = (value, path, required) => !required && (value !== undefined || added.has(keyOf(path)));

/** Edits that make a group one of another kind; a load that moves otherwise takes its motion along. */
function turned(path, schema, value, name) {
  const load = path.at(-1) === "load", start = (load && context.schemas.starts?.[name]) || {};
  fields.moving(axisOf(path, load ? name : undefined));
  const edits = turnedInto(path, schema, value, name, context.root, { needed: needed(schema, name), start: start.load ?? {} });
  return load ? [...edits, ...moved(path, value?.kind, name)] : edits;
}

/** What a kind needs; the fields of an axis may as well be the machine's, so that its schema requires none. */
function needed(schema, name) {
  const { group } = chosen(schema, { [schema.kinds.key]: name });
  return context.schemas.spec.$defs[group.title]?.required ?? [];
}

const at = (path) => path.reduce((value, step) => value?.[step], context.data);

/** Along a line or about an axis: how the load of a place moves. */
function axisOf(path, kind) {
  const own = path[0] === "axes" ? at([path[0], path[1], "load", "kind"]) : undefined;
  return context.schemas.axes?.[kind ?? own ?? context.data.load?.kind];
}

/** Edits of the motion where a load turned from one along a line to one about an axis, or brings its own motion. */
function moved(path, from, to) {
  const axes = context.schemas.axes ?? {}, place = [...path.slice(0, -1), "motion"], motion = at(place);
  if (axes[from] === axes[to]) return [];
  if (motion) resting.set(`${place} ${axes[from]}`, motion);
  if (!axes[to]) return [[place, null, false]];
  return [[place, resting.get(`${place} ${axes[to]}`) ?? context.schemas.starts?.[to]?.motion ?? null, false]];
}

function list(schema, value, path, required) {
  const inside = value.map((one, n) => field(schema.items, one, [...path, n], false));
  const more = small(value.length ? "add another" : "add one", `add to ${words(path.at(-1))}`, () => {
    fields.moving(axisOf(path));
    const place = [...path, value.length], items = resolved(schema.items, context.root);
    opened.set(keyOf(place), true);
    focusNext(place);
    context.act([[place, example(schema.items, context.root), isText(items)]]);
  }, [...path, "+"]);
  const tools = removable(value.length ? value : undefined, path, required) ? [more, remover(path)] : [more];
  return group(path, [...inside, element("p", { className: "add" }, ...tools)], schema, value.length ? value : undefined);
}

function group(path, inside, schema, value) {
  const key = keyOf(path), name = path.at(-1);
  const wrong = context.faults.some((one) => path.every((step, n) => one.path[n] === step));
  const made = element("details", { open: wrong || (opened.get(key) ?? (added.has(key) || openAtFirst(path))) });
  made.addEventListener("toggle", () => opened.set(key, made.open));
  const head = element("span", { textContent: typeof name === "number" && value ? [name + 1, value.name ?? words(value.kind ?? "")].filter(Boolean).join(" · ") : words(name) });
  const summary = element("summary", { dataset: { key: keyOf([...path, "="]) }, title: schema.description?.split("\n\n")[0] ?? "" }, head, element("small", { textContent: digest(value) }));
  made.append(summary, element("div", { className: "group" }, ...elsewhere(path), ...inside));
  return made;
}

function openAtFirst(path) {
  const name = path.at(-1), above = path.slice(0, -1);
  const beside = at(above);
  if (typeof name === "number") return beside?.length <= SHORT && path[0] !== "cases";
  if (above.length === 1 && above[0] === "axes") return Object.keys(beside ?? {}).length <= 1;
  return above.length === 0 || above[0] === "axes" ? OPEN.has(name) : true;
}

/** What is in a group, in a line: shown where it is closed. */
function digest(value) {
  if (value === null || typeof value !== "object") return "";
  const parts = Object.entries(value).filter(([name]) => name !== "name").map(([, one]) => (typeof one === "object" && !isOpen(one) ? words(one?.kind ?? "") : written(one)));
  if (Array.isArray(value) && value.every((one) => typeof one === "object")) return value.map((one) => one?.name ?? one?.kind ?? "").filter(Boolean).map(words).join(" · ") || `${value.length}`;
  return parts.filter(Boolean).join(" · ");
}

function remover(path) {
  return small("remove", `remove ${words(path.at(-1))}`, () => { added.delete(keyOf(path)); context.act([[path, null, false]]); }, [...path, "-"]);
}

// -- one field: its label, its input, its help, what is wrong with it, and what else may be done with it

const RANGE = /^([-+]?\d+(?:\.\d+)?)\s*([^.\s].*?)?\s*\.\.\s*([-+]?\d+(?:\.\d+)?)\s*(.*)$/; // 1 m/s .. 2 m/s
const PLAIN = / with unit$|^a plain number or percent$/; // says what the value says itself

/** A field of one value. */
function single(schema, value, path, required) {
  const plain = written(value);
  const options = isOpen(value) ? null : schema.enum ?? (schema.type === "boolean" ? [true, false] : schema.const !== undefined ? [schema.const] : null);
  const input = options ? picked(schema, options, plain, path) : typed(schema, plain, path, required);
  const beside = [];
  if (/^[-+]?[\d.]/.test(plain) && !options && isFigure(schema)) beside.push(slider(path, schema.type === "integer"));
  if (plain !== "" && !required) beside.push(small("×", `remove ${words(path.at(-1))}`, () => context.act([[path, null, false]]), [...path, "-"]));
  return row(input, path, schema.description, beside);
}

function picked(schema, options, plain, path) {
  const said = (one) => (one === true ? "yes" : one === false ? "no" : words(one));
  const now = plain || String(schema.default ?? options[0]);
  const input = element("select", {}, ...options.map((one) => element("option", { value: String(one), textContent: said(one), selected: String(one) === now })));
  if (plain && !options.some((one) => String(one) === plain)) input.prepend(element("option", { value: plain, textContent: plain, selected: true }));
  input.addEventListener("change", () => context.act([[path, schema.type === "boolean" ? input.value === "true" : input.value, isText(schema)]]));
  return input;
}

/** What is typed counts when the field is left, or with Enter; a form that is drawn anew takes it along. */
function typed(schema, plain, path, required) {
  const input = element("input", { type: "text", value: plain, defaultValue: plain, placeholder: hint(schema, required), autocomplete: "off", spellcheck: false });
  let sent = plain;
  const commit = () => {
    const text = input.value.trim();
    if (!input.isConnected || text === sent) return;
    const [, low, one = "", high, unit] = RANGE.exec(text) ?? [], own = ["", plain.replace(/^[-+\d.eE]+\s*/, "")];
    if (high && own.includes(one) && own.includes(unit) && isFigure(schema)) { // it is free between these
      input.value = plain;
      context.slide({ path, whole: schema.type === "integer", low: Number(low), high: Number(high) });
      return;
    }
    sent = text;
    added.delete(keyOf(path));
    const value = isFigure(schema) ? read(text) : text;
    context.act([[path, text === "" ? null : value, value === text && isText(schema)]]);
  };
  input.addEventListener("change", commit);
  input.addEventListener("blur", commit);
  return input;
}

function hint(schema, required) {
  if (schema.default !== undefined && schema.default !== null && typeof schema.default !== "object") return String(schema.default);
  return schema.examples?.length ? `e.g. ${schema.examples[0]}` : required ? "required" : "";
}

/** A label beside its input, and below them help and errors. */
function row(input, path, description, beside = []) {
  const key = keyOf(path), id = `field-${(context.count += 1)}`;
  input.id = id;
  input.dataset.key = key;
  const made = element("div", { className: "field" }, element("label", { htmlFor: id }, words(path.at(-1)), ...symbol(path)), input, element("span", { className: "beside" }, ...beside));
  const ids = [];
  const say = (className, text) => {
    const said = element("p", { className, id: `${id}-${ids.length}`, textContent: text });
    ids.push(said.id);
    made.append(said);
  };
  const help = (description ?? "").split("\n\n")[0];
  if (help && !PLAIN.test(help)) say("help", help);
  for (const one of context.faults.filter((fault) => keyOf(fault.path) === key)) {
    one.shown = true;
    say("error", one.text);
    input.setAttribute("aria-invalid", "true");
  }
  if (ids.length) input.setAttribute("aria-describedby", ids.join(" "));
  return made;
}

/** The symbol of a load's field in its sketch. */
function symbol(path) {
  const load = path.at(-2) === "load" ? at(path.slice(0, -1)) : null;
  const found = context.schemas.symbols?.[load?.kind]?.[path.at(-1)];
  if (!found) return [];
  const [base, index] = found.split("_");
  return [element("i", { className: "symbol", aria: { hidden: "true" } }, base, ...(index ? [element("sub", { textContent: index })] : []))];
}

function slider(path, whole) {
  const name = path.filter((step) => typeof step === "string").map(words).join(" ");
  const made = small("", `slider for ${name}`, () => context.slide({ path, whole }), [...path, "~"]);
  made.classList.add("slides");
  return made;
}

function small(text, label, does, path) {
  return button(text, does, { className: "small", title: label, aria: { label }, dataset: { key: keyOf(path) } });
}

// -- the keyboard's place in a form that is drawn anew

/** Gives the keyboard to a field as soon as it is there. */
function focusNext(path) {
  setTimeout(() => { if (!focus(path, true)) wantedFocus = path; });
}

function fieldAt(key) {
  return form.querySelector(`[data-key="${CSS.escape(key)}"]`);
}

/** Shows a field and gives it the keyboard; else, unless `exactly` it is wanted, the group that it would be in. */
export function focus(path, exactly = false) {
  for (let length = path.length; length > 0; length -= 1) {
    const key = keyOf(path.slice(0, length));
    const found = fieldAt(key) ?? firstIn(key);
    if (!found && exactly) return false;
    if (!found) continue;
    for (let group = found.closest("details"); group; group = group.parentElement.closest("details")) group.open = true;
    found.focus({ preventScroll: true });
    if (found.type === "text") found.select();
    found.scrollIntoView({ block: "center" });
    return true;
  }
  return false;
}

/** The first field of a group, or its head. */
function firstIn(key) {
  const head = fieldAt(`${key}\u001f=`);
  return head?.parentElement.querySelector("input, select") ?? head;
}

/** Draws, and gives the keyboard back: to the same field with what is typed in it, or to its nearest neighbour. */
function keepingFocus(draw) {
  const active = form.contains(document.activeElement) ? document.activeElement : null;
  const place = active?.dataset.key;
  const order = [...form.querySelectorAll("[data-key]")].map((one) => one.dataset.key);
  const typing = active?.tagName === "INPUT" ? { text: active.value, dirty: active.value !== active.defaultValue, at: active.selectionStart } : null;
  draw();
  if (wantedFocus && focus(wantedFocus, true)) wantedFocus = null;
  else if (place !== undefined) restoreFocus(place, order, typing);
}

function restoreFocus(place, order, typing) {
  const at = order.indexOf(place);
  const again = fieldAt(place) ?? [...order.slice(0, at).reverse(), ...order.slice(at)].map((key) => fieldAt(key)).find((one) => one?.checkVisibility());
  if (!again) return;
  again.focus({ preventScroll: true });
  if (!typing || again.tagName !== "INPUT" || again.dataset.key !== place) return;
  if (typing.dirty && typing.text.trim() !== again.value) again.value = typing.text;
  again.setSelectionRange(typing.at, typing.at);
}
