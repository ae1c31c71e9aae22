"use strict";
// The section "Choose by weights": its controls, its table in the order of the weights, and the address that keeps them.

const FEW = 20, MOST = 1000, PAUSE = 400; // rows that are seen at first; the largest weight; ms before it is announced

/** Joins controls and table of the section below an element, if there is one. */
function weighable(root) {
  const section = root.querySelector("#weights-choice");
  if (!section) return; // no drives to choose from

  const { figures, first } = JSON.parse(section.querySelector("#weights-data").textContent);
  const body = section.querySelector("tbody"), best = section.querySelector(".pill.best");
  const rows = new Map([...body.rows].map((row) => [Number(row.dataset.row), row]));
  const controls = [...section.querySelectorAll(".weight")].map((box) => ({
    name: box.dataset.name, title: box.querySelector("label").textContent, own: Number(box.dataset.own),
    slider: box.querySelector("[type=range]"), field: box.querySelector("[type=number]"),
  }));
  const all = section.querySelector(".all"), said = section.querySelector("[role=status]");
  const command = section.querySelector(".command"), objective = command.querySelector("span");
  let waiting = 0, whole = false;

  const within = (value) => (Number.isFinite(value) ? Math.min(Math.max(value, 0), MOST) : 0);
  const weights = () => Object.fromEntries(controls.map(({ name, field }) => [name, within(field.valueAsNumber)]));

  function set(wanted) {
    for (const { name, slider, field } of controls) {
      field.value = within(wanted[name] ?? 0);
      slider.value = field.value;
    }
  }

  /** Weights as the command line and the address have them, such as mass=2,price=1. */
  const named = (wanted) => wanted.map(([name, weight]) => `${name}=${weight}`).join(",");

  const nameOf = (row) => [...row.querySelectorAll(".part")].map((cell) => cell.textContent).filter(Boolean).join(" + ");

  function sentence(order, score, lacking, now) {
    const counted = controls.filter(({ name }) => now[name] > 0).map(({ name, title }) => `${title} ${now[name]}`);
    if (!counted.length) return "No figure has a weight above zero: the drives are in the order of their smallest margins.";
    const place = order.indexOf(first) + 1;
    const mean = lacking[order[0]] ? "of unknown score" : `score ${score[order[0]].toFixed(3)}`;
    const other = place === 1 ? "It is also the best by the spec's objective."
      : `The best by the spec's objective, ${nameOf(rows.get(first))}, is in place ${place}.`;
    return `The best by ${counted.join(", ")}: ${nameOf(rows.get(order[0]))}, ${mean}. ${other}`;
  }

  /** Rows in their order, with place and score; of many the first ones, and the best by the spec's objective. */
  function laidOut({ order, score, lacking }, counts) {
    order.forEach((drive, n) => {
      const row = rows.get(drive);
      row.cells[0].textContent = n + 1;
      row.querySelector(".score").textContent = !counts ? "" : lacking[drive] ? "unknown" : score[drive].toFixed(3);
      row.hidden = !whole && n >= FEW && drive !== first;
      row.classList.toggle("lit", n === 0);
    });
    body.append(...order.map((drive) => rows.get(drive)));
    rows.get(order[0]).querySelector(".marks").prepend(best);
    all.hidden = order.length <= FEW;
    all.setAttribute("aria-expanded", whole);
    all.textContent = whole ? `Show the first ${FEW}` : `Show all ${order.length}`;
  }

  function ranked(announce) {
    const now = weights(), found = byWeights(figures, now);
    const counted = Object.entries(now).filter(([, weight]) => weight > 0);
    laidOut(found, counted.length > 0);
    objective.textContent = named(counted);
    command.hidden = !counted.length || now.parts > 0; // the search does not count parts
    clearTimeout(waiting);
    waiting = setTimeout(() => {
      said.textContent = sentence(found.order, found.score, found.lacking, now);
      if (announce && !document.body.classList.contains("live")) history.replaceState(null, "", `#weights:${named(counted)}`);
    }, announce ? PAUSE : 0);
  }

  /** Weights out of the address; null where it has none that this page knows. */
  function given() {
    let hash = location.hash;
    try { hash = decodeURIComponent(hash); } catch { /* as it is */ }
    if (!hash.startsWith("#weights:")) return null;
    const pairs = hash.slice("#weights:".length).split(",").map((pair) => pair.split("="));
    const known = pairs.filter(([name, weight]) => controls.some((one) => one.name === name) && /^\d*\.?\d+$/.test(weight));
    return known.length ? Object.fromEntries(known.map(([name, weight]) => [name, Number(weight)])) : null;
  }

  function fromAddress() {
    const found = section.isConnected && given();
    if (!found) return;
    set(found);
    ranked(false);
    (section.closest("section") ?? section).scrollIntoView();
  }

  for (const { slider, field } of controls) {
    slider.addEventListener("input", () => { field.value = slider.value; ranked(true); });
    field.addEventListener("input", () => { slider.value = within(field.valueAsNumber); ranked(true); });
    field.addEventListener("change", () => { field.value = within(field.valueAsNumber); });
  }
  section.querySelector(".own").addEventListener("click", () => {
    set(Object.fromEntries(controls.map(({ name, own }) => [name, own])));
    ranked(true);
  });
  section.querySelector(".equal").addEventListener("click", () => {
    set(Object.fromEntries(controls.map(({ name }) => [name, 1])));
    ranked(true);
  });
  all.addEventListener("click", () => { whole = !whole; ranked(false); });
  addEventListener("hashchange", fromAddress);
  for (const hidden of section.querySelectorAll(".by-script")) hidden.hidden = false;
  ranked(false);
  fromAddress();
}
