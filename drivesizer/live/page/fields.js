// The schema of a spec as fields: which there are at a place, and what each may be.

/** A schema with its references followed and null left out. */
export function resolved(schema, root) {
  let found = schema ?? {};
  for (let depth = 0; depth < 20; depth += 1) {
    if (found.$ref) {
      const { $ref, ...beside } = found;
      found = { ...$ref.split("/").slice(1).reduce((at, key) => at[key], root), ...beside };
      continue;
    }
    const choices = found.anyOf ?? found.oneOf;
    if (!choices || found.discriminator) return found;
    const real = choices.filter((one) => one.type !== "null");
    if (real.length !== 1) return { ...found, choices: real };
    const { anyOf, oneOf, ...beside } = found;
    found = { ...real[0], ...beside, ...(real[0].description && !beside.description ? { description: real[0].description } : {}) };
  }
  return found;
}

/** Of several things that a field may be, the one that its value is; the plainest where there is none. */
export function branch(schema, value, root) {
  const found = resolved(schema, root);
  if (!found.choices) return found;
  const kind = Array.isArray(value) ? "array" : value === null || typeof value !== "object" ? "scalar" : "object";
  const options = found.choices.map((one) => resolved(one, root));
  const fits = options.find((one) => kindOf(one) === kind) ?? options.find((one) => kindOf(one) === "scalar") ?? options[0];
  const { choices, ...beside } = found;
  return { ...beside, ...fits, description: found.description ?? fits.description };
}

function kindOf(schema) {
  if (schema.discriminator || schema.type === "object" || schema.properties) return "object";
  return schema.type === "array" ? "array" : "scalar";
}

/** The group of fields that a value of several kinds has, by its `kind` or `profile`. */
export function chosen(schema, value, root) {
  if (!schema.discriminator) return { group: schema };
  const { propertyName: key, mapping } = schema.discriminator;
  const names = Object.keys(mapping);
  const first = resolved(schema.oneOf[0], root).properties?.[key]?.default;
  const name = value?.[key] ?? first ?? names[0];
  return { key, names, name, group: resolved({ $ref: mapping[name] ?? mapping[names[0]] }, root) };
}

/** Edits that make a group one of another kind: what both have stays, what is required gets an example. */
export function turnedInto(path, schema, value, name, root) {
  const { key } = chosen(schema, value, root);
  const { group } = chosen(schema, { [key]: name }, root);
  const edits = Object.keys(value ?? {}).filter((one) => one !== key && !(one in group.properties)).map((one) => [[...path, one], null, false]);
  edits.unshift([[...path, key], name, true]);
  for (const one of group.required ?? []) {
    if (one === key || (value && one in value)) continue;
    edits.push([[...path, one], example(group.properties[one], root), false]);
  }
  return edits;
}

/** A value with which a field can begin. */
export function example(schema, root) {
  const found = branch(schema, undefined, root);
  if (found.discriminator) {
    const { key, name, group } = chosen(found, undefined, root);
    return { [key]: name, ...required(group, root, key) };
  }
  if (found.examples?.length) return found.examples[0];
  if (found.const !== undefined) return found.const;
  if (found.enum) return found.enum[0];
  if (found.default !== undefined && found.default !== null) return found.default;
  if (found.properties) return required(found, root);
  if (found.type === "array") return [example(found.items, root)];
  if (found.type === "boolean") return true;
  if (found.type === "integer") return found.minimum ?? 1;
  return Array.isArray(found.type) ? 0.9 : "";
}

function required(group, root, but) {
  const names = (group.required ?? []).filter((name) => name !== but);
  return Object.fromEntries(names.map((name) => [name, example(group.properties[name], root)]));
}

/** Whether a field is a text, in which a number is no number. */
export function isText(schema) {
  return schema.type === "string" && !schema.examples && !/with unit/.test(schema.description ?? "") && !schema.enum;
}
