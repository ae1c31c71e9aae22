"use strict";
// The page: tables that sort, and figures that plotly.js draws out of the plain data in #figures.

// -- tables ------------------------------------------------------------------------------------------------------

/** What a cell is sorted by: its number where it has one, else its text; undefined for what is not known. */
function keyOf(cell) {
  const data = cell.querySelector("data");
  if (data) return Number(data.value);
  const text = cell.textContent.trim();
  const number = /^[−-]?\d/.test(text) ? Number.parseFloat(text.replace("−", "-")) : Number.NaN;
  if (!Number.isNaN(number)) return number;
  return text === "" || text === "unknown" ? undefined : text;
}

function compared(a, b) {
  if (typeof a === "number" && typeof b === "number") return a - b;
  return String(a).localeCompare(String(b), "en", { numeric: true });
}

/** Sorts a table by a column: upwards first, the other way when it is so already; what is unknown stays last. */
function sortBy(head) {
  const table = head.closest("table"), body = table.tBodies[0];
  const place = head.cellIndex, way = head.getAttribute("aria-sort") === "ascending" ? -1 : 1;
  const rows = [...body.rows].map((row) => ({ row, key: keyOf(row.cells[place]) }));
  rows.sort((a, b) => {
    if (a.key === undefined || b.key === undefined) return (a.key === undefined) - (b.key === undefined);
    return way * compared(a.key, b.key);
  });
  body.append(...rows.map(({ row }) => row));
  for (const other of table.tHead.rows[0].cells) if (other.hasAttribute("aria-sort")) other.setAttribute("aria-sort", "none");
  head.setAttribute("aria-sort", way === 1 ? "ascending" : "descending");
}

for (const button of document.querySelectorAll(".sortable thead button")) {
  button.addEventListener("click", () => sortBy(button.closest("th")));
}

/** Shows at which side a table goes on. */
function cue(box) {
  const rest = box.scrollWidth - box.clientWidth - box.scrollLeft;
  box.parentElement.classList.toggle("more", rest > 1);
  box.parentElement.classList.toggle("before", box.scrollLeft > 1);
}

const resized = new ResizeObserver((entries) => { for (const { target } of entries) cue(target); });
for (const box of document.querySelectorAll(".scroll")) {
  box.addEventListener("scroll", () => cue(box), { passive: true });
  resized.observe(box);
}

// -- colours -----------------------------------------------------------------------------------------------------

const NAMES = ["blue", "vermillion", "green", "purple", "grey", "orange", "ink", "soft", "hair", "grid", "page"];

/** The values of the named colours, as the page has them now or as paper has them. */
function palette(printing) {
  const found = getComputedStyle(printing ? document.getElementById("paper") : document.documentElement);
  return Object.fromEntries(NAMES.map((name) => [name, found.getPropertyValue(`--${name}`).trim()]));
}

/** Data or layout with colours in place of their names. */
function coloured(value, colours) {
  return JSON.parse(JSON.stringify(value), (key, entry) => (/color$/.test(key) && colours[entry]) || entry);
}

function dressed(plot, printing) {
  const colours = palette(printing);
  const axis = { gridcolor: colours.grid, zerolinecolor: colours.soft, linecolor: colours.soft, tickcolor: colours.soft,
    ticks: "outside", ticklen: 4, automargin: true, spikecolor: colours.soft, spikethickness: 1, spikedash: "dot",
    spikemode: "across", title: { standoff: 8 }, exponentformat: "none" };
  const layout = coloured(plot.layout, colours);
  return { data: coloured(plot.data, colours), layout: { ...layout,
    autosize: true, showlegend: false, uirevision: "kept", paper_bgcolor: "rgba(0,0,0,0)", plot_bgcolor: "rgba(0,0,0,0)",
    font: { family: getComputedStyle(document.body).fontFamily, size: printing ? 10 : 12, color: colours.ink },
    separators: ".\u202f", margin: { l: 44, r: 12, t: 24, b: 40 }, dragmode: matchMedia("(pointer: coarse)").matches ? false : "zoom",
    hoverlabel: { bgcolor: colours.page, bordercolor: colours.hair, font: { color: colours.ink, size: 12 }, align: "left" },
    template: { layout: { xaxis: axis, yaxis: axis } } } };
}

// -- figures -----------------------------------------------------------------------------------------------------

const plots = JSON.parse(document.getElementById("figures").textContent);
const drawings = [...document.querySelectorAll(".drawing")];
// The buttons by name, so that none that a later plotly.js adds appears: one of them sends the figure to a server.
const CONFIG = { responsive: true, displaylogo: false, plotlyServerURL: "",
  modeBarButtons: [["toImage"], ["zoom2d", "pan2d"], ["zoomIn2d", "zoomOut2d", "resetScale2d"]] };

/** Shows or hides the traces of a button. */
function toggle(drawing, button) {
  const shown = button.getAttribute("aria-pressed") !== "true";
  button.setAttribute("aria-pressed", shown);
  Plotly.restyle(drawing, { visible: shown ? true : "legendonly" }, JSON.parse(button.dataset.traces));
}

function look(drawing, button) {
  for (const other of button.parentElement.children) other.setAttribute("aria-pressed", other === button);
  const relaid = { "xaxis.range": JSON.parse(button.dataset.range) };
  for (const name of Object.keys(drawing.layout)) if (/^yaxis/.test(name)) relaid[`${name}.autorange`] = true;
  Plotly.relayout(drawing, relaid);
}

/** A point with all its figures, selected with the arrow keys: left and right along a line, up and down to others. */
function stepTo(drawing, key) {
  const lines = drawing.data.map((trace, n) => n).filter((n) => drawing.data[n].visible !== "legendonly" && drawing.data[n].hoverinfo !== "skip");
  if (!lines.length) return;
  const at = drawing.chosen ?? { line: 0, point: -1 };
  if (key === "ArrowUp" || key === "ArrowDown") {
    at.line += key === "ArrowUp" ? lines.length - 1 : 1;
    at.point = 0;
  } else at.point += key === "ArrowRight" ? 1 : -1;
  at.line %= lines.length;
  const count = drawing.data[lines[at.line]].x.length;
  at.point = (at.point + count) % count;
  drawing.chosen = at;
  Plotly.Fx.hover(drawing, [{ curveNumber: lines[at.line], pointNumber: at.point }]);
}

function zoom(drawing, factor) {
  const relaid = {};
  for (const [name, axis] of Object.entries(drawing._fullLayout)) {
    if (!/^[xy]axis\d*$/.test(name)) continue;
    const [low, high] = axis.range, middle = (low + high) / 2, half = (factor * (high - low)) / 2;
    relaid[`${name}.range`] = [middle - half, middle + half];
  }
  Plotly.relayout(drawing, relaid);
}

/** Back to what was seen first. */
function reset(drawing) {
  const relaid = {}, first = plots[drawing.dataset.plot].layout;
  for (const name of Object.keys(first)) {
    if (/^[xy]axis\d*$/.test(name)) relaid[first[name].range ? `${name}.range` : `${name}.autorange`] = first[name].range?.slice() ?? true;
  }
  Plotly.relayout(drawing, relaid);
}

function keyed(event) {
  const drawing = event.currentTarget;
  const does = { "+": () => zoom(drawing, 0.7), "-": () => zoom(drawing, 1 / 0.7), "0": () => reset(drawing),
    Escape: () => Plotly.Fx.unhover(drawing) }[event.key];
  if (event.ctrlKey || event.metaKey || event.altKey || (!does && !event.key.startsWith("Arrow"))) return;
  event.preventDefault();
  (does ?? (() => stepTo(drawing, event.key)))();
}

/** The row of a set that was clicked in a figure. */
function lit(event) {
  const rank = event.points[0].customdata?.[0];
  for (const row of document.querySelectorAll("#sets tr[data-rank]")) {
    row.classList.toggle("lit", row.dataset.rank === rank);
    if (row.dataset.rank === rank) row.scrollIntoView({ block: "center" });
  }
}

async function draw(drawing) {
  const plot = plots[drawing.dataset.plot], { data, layout } = dressed(plot, false);
  await Plotly.newPlot(drawing, data, layout, CONFIG);
  drawing.addEventListener("keydown", keyed);
  drawing.on("plotly_relayout", (change) => { if (change["xaxis.autorange"]) reset(drawing); });
  if (drawing.dataset.plot.startsWith("sets-")) drawing.on("plotly_click", lit);
  const controls = drawing.closest("figure").querySelector(".controls");
  for (const button of controls?.querySelectorAll("button") ?? []) {
    button.addEventListener("click", () => (button.dataset.traces ? toggle : look)(drawing, button));
  }
}

/** Colours anew, and for paper its width; what is hidden or zoomed stays so. */
function redress(printing) {
  for (const drawing of drawings.filter((d) => d.data)) {
    const { data, layout } = dressed(plots[drawing.dataset.plot], printing);
    data.forEach((trace, n) => { trace.visible = drawing.data[n].visible; });
    for (const name of Object.keys(layout)) if (/^[xy]axis\d*$/.test(name)) layout[name].range = drawing.layout[name].range;
    const width = drawing.closest(".pair")?.children.length > 1 ? 312 : 655; // px, of 176 mm or half of it
    Plotly.react(drawing, data, printing ? { ...layout, autosize: false, width } : layout, CONFIG);
  }
}

/** plotly.js, packed with zlib. */
async function unpacked() {
  const letters = atob(document.getElementById("library").textContent), packed = new Uint8Array(letters.length);
  for (let n = 0; n < letters.length; n += 1) packed[n] = letters.charCodeAt(n);
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Response(stream).text();
}

async function drawAll() {
  try {
    const script = document.createElement("script");
    script.textContent = await unpacked();
    document.head.append(script);
    for (const drawing of drawings) {
      await new Promise((next) => setTimeout(next)); // the page answers between one figure and the next
      await draw(drawing);
    }
  } catch (error) {
    for (const drawing of drawings.filter((d) => !d.data)) {
      drawing.textContent = "This browser cannot draw the figures; a current one can.";
      drawing.className = "wanting";
      drawing.style.height = "auto";
    }
    throw error;
  } finally {
    document.documentElement.dataset.drawn = drawings.filter((d) => d.data).length;
  }
}

addEventListener("beforeprint", () => redress(true));
addEventListener("afterprint", () => redress(false));
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => redress(false));
drawAll();

// -- contents ----------------------------------------------------------------------------------------------------

const links = new Map([...document.querySelectorAll("nav a")].map((a) => [a.hash.slice(1), a]));
const watch = new IntersectionObserver((entries) => {
  const seen = entries.find((entry) => entry.isIntersecting);
  if (!seen) return;
  for (const [id, link] of links) {
    if (id === seen.target.getAttribute("aria-labelledby")) link.setAttribute("aria-current", "true");
    else link.removeAttribute("aria-current");
  }
}, { rootMargin: "-10% 0px -80% 0px" });
for (const section of document.querySelectorAll("main > section")) watch.observe(section);
const contents = document.querySelector("nav details");
if (matchMedia("(max-width: 62rem)").matches) contents.open = false;
