// The keyboard's place in a form that is drawn anew.

import { keyOf } from "./dom.js";

/** Keeps the place of the keyboard; a class, for it remembers where the keyboard is to go when a field has come. */
export class Focus {
  constructor(form) {
    this.form = form;
    this.wanted = null;
    for (const name of ["keydown", "pointerdown"]) addEventListener(name, () => { this.wanted = null; }, true);
  }

  /** Gives the keyboard to a field as soon as it is there. */
  next(path) {
    setTimeout(() => { if (!this.to(path, true)) this.wanted = path; });
  }

  find(key) {
    return this.form.querySelector(`[data-key="${CSS.escape(key)}"]`);
  }

  /** Shows a field and gives it the keyboard; else, unless `exactly` it is wanted, the group that it would be in. */
  to(path, exactly = false) {
    for (let length = path.length; length > 0; length -= 1) {
      const key = keyOf(path.slice(0, length));
      const found = this.find(key) ?? this.inside(key);
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
  inside(key) {
    const head = this.find(`${key}\u001f=`);
    return head?.parentElement.querySelector("input, select") ?? head;
  }

  /** Draws, and gives the keyboard back: to the same field with what is typed in it, or to its nearest neighbour. */
  kept(draw) {
    const active = this.form.contains(document.activeElement) ? document.activeElement : null;
    const place = active?.dataset.key;
    const order = [...this.form.querySelectorAll("[data-key]")].map((one) => one.dataset.key);
    const typing = active?.tagName === "INPUT" ? { text: active.value, dirty: active.value !== active.defaultValue, at: active.selectionStart } : null;
    draw();
    if (this.wanted && this.to(this.wanted, true)) this.wanted = null;
    else if (place !== undefined) this.restore(place, order, typing);
  }

  restore(place, order, typing) {
    const at = order.indexOf(place);
    const again = this.find(place) ?? [...order.slice(0, at).reverse(), ...order.slice(at)].map((key) => this.find(key)).find((one) => one?.checkVisibility());
    if (!again) return;
    again.focus({ preventScroll: true });
    if (!typing || again.tagName !== "INPUT" || again.dataset.key !== place) return;
    if (typing.dirty && typing.text.trim() !== again.value) again.value = typing.text;
    again.setSelectionRange(typing.at, typing.at);
  }
}
