// The schema of a spec as fields: which there are at a place, and what each may be.

const KINDS = ["kind", "profile"]; // fields that say of which kind a group is

const FREE = /^free\s+(.+?)(?:\s+step\s+(.+))?$/;

/** A free figure, or one that follows from others, as it is typed in its field; anything else as it is. */
export function written(value) {
  if (value?.expression !== undefined) return `= ${value.expression}`;
  if (value?.free === undefined) return value === undefined || value === null ? "" : typeof value === "object" ? JSON.stringify(value) : String(value);
  const list = Array.isArray(value.free) ? `[${value.free.map(written).join(", ")}]` : value.free;
  return `free ${list}${value.step === undefined ? "" : ` step ${value.step}`}`;
}

/** What is typed in a field as the spec has it: free 120 mm .. 250 mm step 10 mm, free [2, 4], = 2 * load.mass. */
export function read(text) {
  if (text.startsWith("=")) return { expression: text.slice(1).trim() };
  const [, space, step] = FREE.exec(text) ?? [];
  if (!space) return text;
  const one = (part) => (part.trim() !== "" && Number.isFinite(Number(part)) ? Number(part) : part.trim());
  const free = /^\[.*\]$/.test(space) ? space.slice(1, -1).split(",").map(one) : space;
  return step === undefined ? { free } : { free, step };
}

export const isOpen = (value) => value?.free !== undefined || value?.expression !== undefined;

/** A schema with its references followed and null left out; `kinds` or `choices` where it may be several things. */
export function resolved(schema, root) {
  let found = schema ?? {};
  for (let depth = 0; depth < 20; depth += 1) {
    if (found.$ref) {
      const { $ref, ...beside } = found;
      found = { ...$ref.split("/").slice(1).reduce((at, key) => at[key], root), ...beside };
      continue;
    }
    const choices = found.anyOf ?? found.oneOf;
    if (!choices) return found;
    const real = choices.filter((one) => one.type !== "null");
    const { anyOf, oneOf, discriminator, ...beside } = found;
    if (real.length !== 1) return several(beside, real.map((one) => resolved(one, root)));
    found = { ...real[0], ...beside, ...(real[0].description && !beside.description ? { description: real[0].description } : {}) };
  }
  return found;
}

/** A group that may be of several kinds, where each says which it is; else simply several things. */
function several(beside, options) {
  const key = KINDS.find((name) => options.every((one) => one.properties?.[name]));
  if (!key) return { ...beside, choices: options };
  const groups = {};
  for (const one of options) for (const name of one.properties[key].enum ?? [one.properties[key].const]) groups[name] = one;
  return { ...beside, kinds: { key, groups } };
}

/** Of several things that a field may be, the one that its value is; the plainest where there is none. */
export function branch(schema, value, root) {
  const found = resolved(schema, root);
  if (!found.choices) return found;
  const kind = Array.isArray(value) ? "array" : value === null || typeof value !== "object" ? "scalar" : "object";
  const fits = found.choices.find((one) => kindOf(one) === kind) ?? found.choices.find((one) => kindOf(one) === "scalar") ?? found.choices[0];
  const { choices, ...beside } = found;
  return { ...fits, ...beside, description: found.description ?? fits.description };
}

function kindOf(schema) {
  if (schema.kinds || schema.type === "object" || schema.properties) return "object";
  return schema.type === "array" ? "array" : "scalar";
}

/** The fields of a group that has several kinds, by what its value says, or by the fields that it has. */
export function chosen(schema, value) {
  const { key, groups } = schema.kinds, names = Object.keys(groups);
  const given = Object.keys(value ?? {});
  const holds = (name) => given.every((one) => one in groups[name].properties) && (groups[name].required ?? []).every((one) => one === key || given.includes(one));
  const implied = names.filter((name) => groups[name].properties[key].default === name);
  const name = value?.[key] ?? implied.find(holds) ?? implied[0] ?? names.find(holds) ?? names[0];
  return { key, names: names.sort(), name, group: groups[name] ?? groups[names[0]] };
}

const BEGIN = { ratio: 2, efficiency: 0.95, name: "new" }; // where the schema has no example
// what a kind needs beside what it requires: the one of several ways to say it that the form begins with
const ONE_WAY = { belt: ["ratio"], trapezoid: ["acceleration_time", "cruise_time"] };
const BODY = ["inertia", "cylinders"]; // of another body in another kind of load
const FOLLOWS = { arm: ["inertia"] }; // what follows from other fields where it is not given
const had = new Map(); // fields of a group when it was of another kind, by place and kind
let axis = "linear"; // along which or about which the load moves for which an example is wanted

/** Says for what kind of axis examples are. */
export function moving(how) { axis = how ?? "linear"; }

export function forget() { had.clear(); }

/** Edits that make a group one of another kind: what both have stays, what it needs is as it was before, or an example. */
export function turnedInto(path, schema, value, name, root, { needed = [], start = {} } = {}) {
  const { key, name: before, group: old } = chosen(schema, value);
  const { group } = chosen(schema, { [key]: name });
  const another = old.title !== group.title;
  had.set(`${path} ${before}`, value ?? {});
  const kept = had.get(`${path} ${name}`) ?? {};
  const musts = (of, kind) => [...(of.required ?? []), ...(ONE_WAY[kind] ?? [])];
  const essence = (one) => key === "profile" && musts(old, before).includes(one) && !musts(group, name).includes(one);
  const lost = (one) => !(one in group.properties) || (another && (BODY.includes(one) || essence(one)));
  const edits = [[[...path, key], name, true]];
  for (const one of Object.keys(value ?? {})) if (one !== key && lost(one)) edits.push([[...path, one], null, false]);
  const offered = another ? Object.keys(start).filter((one) => !FOLLOWS[name]?.includes(one)) : [];
  for (const one of new Set([...Object.keys(kept), ...musts(group, name), ...needed, ...offered])) {
    if (one === key || (value && one in value && !lost(one)) || !(one in group.properties)) continue;
    const begin = kept[one] ?? start[one] ?? example(group.properties[one], root, one);
    if (begin !== "") edits.push([[...path, one], begin, isText(resolved(group.properties[one], root))]);
  }
  return edits;
}

/** A value with which a field can begin; an empty text where only its user can know it. */
export function example(schema, root, name = "") {
  const found = branch(schema, undefined, root);
  if (found.kinds) {
    const { key, name: kind, group } = chosen(found, undefined);
    return { [key]: kind, ...required(group, root, key) };
  }
  if (found.examples?.length) return found.examples[axis === "rotary" && found.examples.length === 2 ? 1 : 0];
  if (found.const !== undefined) return found.const;
  if (found.enum) return found.enum[0];
  if (found.default !== undefined && found.default !== null) return found.default;
  if (found.properties) return required(found, root);
  if (found.type === "array") return Array.from({ length: found.minItems ?? 1 }, () => example(found.items, root));
  if (found.type === "boolean") return true;
  if (found.type === "integer") return found.minimum ?? 1;
  return BEGIN[name] ?? ([found.type].flat().includes("number") ? 0.9 : "");
}

function required(group, root, but) {
  const names = (group.required ?? []).filter((name) => name !== but);
  return Object.fromEntries(names.map((name) => [name, example(group.properties[name], root, name)]));
}

/** Whether a field is a text, in which a number is no number. */
export function isText(schema) {
  return schema.type === "string" && !schema.examples && !/with unit/.test(schema.description ?? "") && !schema.enum;
}

/** Whether a field is a figure, which a slider can move: no name and no part number. */
export function isFigure(schema) {
  const types = [schema.type].flat();
  if (types.includes("number")) return true;
  if (types.includes("integer")) return types.length === 1;
  return types.includes("string") && !schema.enum && !isText(schema);
}
