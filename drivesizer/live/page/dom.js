// Elements of the page, and words for what the spec calls a field.

/** An element with its properties and what is in it. */
export function element(tag, properties = {}, ...children) {
  const { dataset, aria, ...own } = properties;
  const made = Object.assign(document.createElement(tag), own);
  Object.assign(made.dataset, dataset);
  for (const [name, value] of Object.entries(aria ?? {})) made.setAttribute(`aria-${name}`, value);
  made.append(...children);
  return made;
}

/** A button with its words; `more` are further properties. */
export function button(words, does, more = {}) {
  const made = element("button", { type: "button", textContent: words, ...more });
  made.addEventListener("click", does);
  return made;
}

/** A name of the spec as words; places of lists count from 1. */
export const words = (step) => (typeof step === "number" ? `${step + 1}` : String(step).replaceAll("_", " "));

export const keyOf = (path) => path.join("\u001f");

/** A button that keeps the keyboard while it does nothing. */
export function enable(made, able) {
  made.setAttribute("aria-disabled", String(!able));
}

export const able = (made) => made.getAttribute("aria-disabled") !== "true";
