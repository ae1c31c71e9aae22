// The answer: its headline at once, then the sections of the report, then their figures.

const headline = document.getElementById("headline");
const report = document.getElementById("report");
let figures = {};
let library = null; // plotly.js, which loads with the first figure

function element(tag, properties = {}, ...children) {
  const made = Object.assign(document.createElement(tag), properties);
  made.append(...children);
  return made;
}

const GROUPED = new Intl.NumberFormat("en", { maximumSignificantDigits: 4 });
const unit = (value, factor, name) => (value === null || value === undefined ? "" : `${GROUPED.format(value * factor)} ${name}`);

export function busy() {
  headline.classList.add("stale");
}

/** What to buy, in three lines. */
export function rank(piece) {
  headline.className = piece.status;
  const best = piece.sets[0];
  if (piece.machine) {
    const rows = piece.axes.map((one) => element("p", { textContent: `${one.axis}: ${one.label ?? "no drive meets all limits"}` }));
    headline.replaceChildren(element("p", { className: "best", textContent: `Machine of ${piece.axes.length} axes: ${piece.status}` }), ...rows);
    return;
  }
  if (!best) {
    headline.replaceChildren(element("p", { className: "best", textContent: "No drive meets all limits." }), element("p", { className: "figures-of", textContent: `${piece.considered.toLocaleString("en")} drives considered; what would let one pass follows.` }));
    return;
  }
  const head = piece.found ? best.label : `No drive meets all limits. The closest: ${best.label}`;
  const figuresOf = [unit(best.mass, 1e3, "g"), unit(best.price, 1, "EUR"), unit(best.energy, 1, "J per cycle")].filter(Boolean).join(" · ");
  const tight = best.tight ? `${best.status}: ${best.tight.title} ${best.tight.said}` : best.status;
  headline.replaceChildren(
    element("p", { className: "best", textContent: head }),
    element("p", { className: "figures-of", textContent: [figuresOf, tight].filter(Boolean).join(" · ") }),
    element("p", { className: "figures-of", textContent: `${piece.considered.toLocaleString("en")} drives considered, ${piece.feasible.toLocaleString("en")} meet all limits, ranked by ${piece.objective.replaceAll("_", " ")}.` }),
  );
}

export function wrong(lines) {
  headline.className = "wrong";
  headline.replaceChildren(...lines.map((line) => element("p", { textContent: line })));
  report.classList.add("stale");
}

/** The sections; one that has not changed stays as it is, and figures keep their drawings. */
export function sections(list) {
  report.classList.remove("stale");
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
  const head = element(one.level === 1 ? "h2" : "h3", {});
  const made = element("section", {}, head, element("div", { className: "part-body" }));
  made.dataset.name = one.name;
  return made;
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

export function plots(given) {
  figures = given;
  for (const drawing of report.querySelectorAll(".drawing")) {
    drawing.outdated = true;
    seen.unobserve(drawing);
    seen.observe(drawing); // reports once whether it is in sight
  }
}

/** Draws a figure that is in sight, or brings it up to date. */
async function current(drawing) {
  const plot = figures[drawing.dataset.plot];
  if (!plot || !drawing.outdated) return;
  drawing.outdated = false;
  await plotly();
  if (!drawing.isConnected) return;
  if (drawing.data) {
    drawing.plot = plot;
    const { data, layout } = dressed(plot, false);
    await Plotly.react(drawing, data, layout, CONFIG);
  } else {
    await draw(drawing, plot);
  }
}

export function still(name, address) {
  const image = document.getElementById(`figure-${name}`)?.querySelector("img");
  if (image) image.src = address;
}

addEventListener("beforeprint", () => redress([...report.querySelectorAll(".drawing")], true));
addEventListener("afterprint", () => redress([...report.querySelectorAll(".drawing")], false));
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => redress([...report.querySelectorAll(".drawing")], false));
