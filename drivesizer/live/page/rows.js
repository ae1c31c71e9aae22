// One field of the form: its label, its input, its help, what is wrong with it, and what else may be done with it.

import { button, element, keyOf, words } from "./dom.js";
import { isFigure, isOpen, isText, read, written } from "./fields.js";

const RANGE = /^([-+]?\d+(?:\.\d+)?)\s*([^.\s].*?)?\s*\.\.\s*([-+]?\d+(?:\.\d+)?)\s*(.*)$/; // 1 m/s .. 2 m/s
const PLAIN = / with unit$|^a plain number or percent$/; // says what the value says itself

/** A field of one value. */
export function single(schema, value, path, context, required) {
  const plain = written(value);
  const options = isOpen(value) ? null : schema.enum ?? (schema.type === "boolean" ? [true, false] : schema.const !== undefined ? [schema.const] : null);
  const input = options ? picked(schema, options, plain, path, context) : typed(schema, plain, path, context, required);
  const beside = [];
  if (/^[-+]?[\d.]/.test(plain) && !options && isFigure(schema)) beside.push(slider(path, schema.type === "integer", context));
  if (plain !== "" && !required) beside.push(small("×", `remove ${words(path.at(-1))}`, () => context.act([[path, null, false]]), [...path, "-"]));
  return row(input, path, schema.description, context, beside);
}

function picked(schema, options, plain, path, context) {
  const said = (one) => (one === true ? "yes" : one === false ? "no" : words(one));
  const now = plain || String(schema.default ?? options[0]);
  const input = element("select", {}, ...options.map((one) => element("option", { value: String(one), textContent: said(one), selected: String(one) === now })));
  if (plain && !options.some((one) => String(one) === plain)) input.prepend(element("option", { value: plain, textContent: plain, selected: true }));
  input.addEventListener("change", () => context.act([[path, schema.type === "boolean" ? input.value === "true" : input.value, isText(schema)]]));
  return input;
}

/** What is typed counts when the field is left, or with Enter; a form that is drawn anew takes it along. */
function typed(schema, plain, path, context, required) {
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
    context.filled(path);
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
export function row(input, path, description, context, beside = []) {
  const key = keyOf(path), id = `field-${(context.count += 1)}`;
  input.id = id;
  input.dataset.key = key;
  const made = element("div", { className: "field" }, element("label", { htmlFor: id }, words(path.at(-1)), ...symbol(path, context)), input, element("span", { className: "beside" }, ...beside));
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
function symbol(path, context) {
  const load = path.at(-2) === "load" ? path.slice(0, -1).reduce((at, step) => at?.[step], context.data) : null;
  const found = context.schemas.symbols?.[load?.kind]?.[path.at(-1)];
  if (!found) return [];
  const [base, index] = found.split("_");
  return [element("i", { className: "symbol", aria: { hidden: "true" } }, base, ...(index ? [element("sub", { textContent: index })] : []))];
}

function slider(path, whole, context) {
  const name = path.filter((step) => typeof step === "string").map(words).join(" ");
  const made = small("", `slider for ${name}`, () => context.slide({ path, whole }), [...path, "~"]);
  made.classList.add("slides");
  return made;
}

export function small(text, label, does, path) {
  return button(text, does, { className: "small", title: label, aria: { label }, dataset: { key: keyOf(path) } });
}
