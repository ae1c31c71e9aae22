// Elements of the page, words for what the spec calls a field, and boxes by which some of many are chosen.

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

/** Some of many to be set side by side, by boxes; two of one `key` are the same, and of more than `most` the first one leaves. */
export function choice(most, key, changed) {
  const chosen = new Map(), boxes = () => [...document.querySelectorAll(`input.compares`)].filter((box) => box.choice === chosen);
  const follow = () => { for (const box of boxes()) box.checked = chosen.has(box.value); };
  return {
    list: () => [...chosen.values()],
    box(one, label) {
      const made = Object.assign(element("input", { type: "checkbox", className: "compares", value: key(one), checked: chosen.has(key(one)), aria: { label } }), { choice: chosen });
      made.addEventListener("change", () => {
        if (made.checked) chosen.set(made.value, one);
        else chosen.delete(made.value);
        if (chosen.size > most) chosen.delete(chosen.keys().next().value);
        follow();
        changed();
      });
      return made;
    },
    clear() {
      const first = boxes().find((box) => box.checked);
      chosen.clear();
      follow();
      return first;
    },
  };
}
