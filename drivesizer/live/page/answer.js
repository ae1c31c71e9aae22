// The answer below its headline: the sections of the report, then their figures.

import { element } from "./dom.js";

const report = document.getElementById("report");
const LOW = 330; // px, of the figure above the report
let figures = {};
let library = null; // plotly.js, which loads with the first figures

export function stale() { report.classList.add("stale"); }

/** The sections; one that has not changed stays as it is, and figures keep their drawings. */
export function sections(list) {
  report.classList.remove("stale");
  if (!list.some((one) => one.html.includes("figure-sketch"))) document.getElementById("sketch").hidden = true; // it was of another spec
  const kept = new Map([...report.querySelectorAll(".drawing")].filter((one) => one.data).map((one) => [one.dataset.plot, one]));
  const there = new Map([...report.children].map((one) => [one.dataset.name, one]));
  const wanted = list.map((one) => filled(there.get(one.name) ?? opened(one), one));
  for (const [n, one] of wanted.entries()) if (report.children[n] !== one) report.insertBefore(one, report.children[n] ?? null);
  while (report.children.length > wanted.length) report.lastElementChild.remove();
  for (const place of report.querySelectorAll(".drawing")) {
    const before = kept.get(place.dataset.plot);
    if (before && before !== place && !place.data) place.replaceWith(before);
  }
}

function opened(one) {
  const head = element(one.level === 1 ? "h2" : "h3", { tabIndex: -1 });
  return element("section", { dataset: { name: one.name } }, head, element("div", { className: "part-body" }));
}

function filled(made, one) {
  made.firstElementChild.textContent = one.title;
  if (made.shown === one.html) return made;
  made.shown = one.html;
  made.lastElementChild.innerHTML = one.html; // of the server's own templates, which escape every text
  tabled(made);
  weighable(made);
  return made;
}

// -- figures

export function plotly() {
  library ??= new Promise((loaded, failed) => {
    const script = element("script", { src: "plotly.js" });
    script.addEventListener("load", loaded);
    script.addEventListener("error", () => { library = null; failed(new Error("plotly.js")); });
    document.head.append(script);
  });
  return library;
}

const seen = new IntersectionObserver((entries) => {
  for (const { target, isIntersecting } of entries) if (isIntersecting) current(target);
}, { rootMargin: "300px" });

const drawings = () => [...document.querySelectorAll("#answer .drawing")];

export function plots(given) {
  figures = given;
  for (const drawing of drawings()) {
    drawing.outdated = true;
    seen.unobserve(drawing);
    seen.observe(drawing); // reports once whether it is in sight
  }
  plotly().catch(() => {}); // a print draws them all
}

/** Draws a figure, or brings it up to date. */
async function current(drawing) {
  if (!figures[drawing.dataset.plot] || !drawing.outdated) return;
  await plotly();
  if (drawing.isConnected && drawing.outdated) await drawn(drawing);
}

function drawn(drawing) {
  const whole = figures[drawing.dataset.plot];
  const plot = drawing.closest("#glance") ? { ...whole, layout: { ...whole.layout, height: LOW } } : whole;
  drawing.outdated = false;
  if (!drawing.data) return draw(drawing, plot);
  drawing.plot = plot;
  const { data, layout } = dressed(plot, false);
  return Plotly.react(drawing, data, layout, CONFIG);
}

export function still(name, address) {
  const image = document.getElementById(`figure-${name}`)?.querySelector("img");
  if (image) image.src = address;
  if (name === "sketch") {
    const beside = document.getElementById("sketch");
    beside.firstElementChild.src = address;
    beside.hidden = false;
  }
}

addEventListener("beforeprint", () => {
  if (window.Plotly) for (const one of drawings()) if (one.outdated && figures[one.dataset.plot]) drawn(one);
  redress(drawings(), true);
});
addEventListener("afterprint", () => redress(drawings(), false));
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => redress([...document.querySelectorAll("#answer .drawing, #browser .drawing")], false));

/** Draws the figures of a place, as soon as what draws them is there. */
export async function drawnIn(root, plots) {
  const places = [...root.querySelectorAll(".drawing")], there = !places.length || await plotly().then(() => true, () => false);
  for (const place of places) {
    if (!there) place.replaceChildren(element("p", { className: "wanting", textContent: "not drawn: the server does not answer" }));
    else if (place.isConnected) await draw(place, plots[place.dataset.plot]);
  }
}
