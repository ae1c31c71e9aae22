"use strict";
// Figures that plotly.js draws out of plain data, in the colours of the page.

// -- colours -----------------------------------------------------------------------------------------------------

const NAMES = ["blue", "vermillion", "green", "purple", "grey", "orange", "sky", "ink", "soft", "hair", "grid", "page"];

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
    ticks: "outside", ticklen: 4, spikecolor: colours.soft, spikethickness: 1, spikedash: "dot",
    spikemode: "across", title: { standoff: 8 }, exponentformat: "none" };
  const layout = coloured(plot.layout, colours);
  return { data: coloured(plot.data, colours), layout: { ...layout,
    autosize: true, showlegend: false, uirevision: "kept", paper_bgcolor: "rgba(0,0,0,0)", plot_bgcolor: "rgba(0,0,0,0)",
    font: { family: getComputedStyle(document.body).fontFamily, size: printing ? 10 : 12, color: colours.ink },
    separators: ".\u202f", margin: { l: 44, r: 12, t: 24, b: 42 }, dragmode: matchMedia("(pointer: coarse)").matches ? false : "zoom",
    hoverlabel: { bgcolor: colours.page, bordercolor: colours.hair, font: { color: colours.ink, size: 12 }, align: "left" },
    // only the labels beside an axis may need room, which hangs on the height alone: margins that hang on one another
    // are drawn again and again
    template: { layout: { xaxis: { ...axis, tickangle: 0 }, yaxis: { ...axis, automargin: true } } } } };
}

// -- figures -----------------------------------------------------------------------------------------------------

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
  const relaid = {}, first = drawing.plot.layout;
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

/** Draws a plot, which the drawing keeps, with its keys and buttons. */
async function draw(drawing, plot) {
  const { data, layout } = dressed(plot, false);
  drawing.plot = plot;
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
function redress(drawings, printing) {
  for (const drawing of drawings.filter((d) => d.data)) {
    const { data, layout } = dressed(drawing.plot, printing);
    data.forEach((trace, n) => { trace.visible = drawing.data[n].visible; });
    for (const name of Object.keys(layout)) if (/^[xy]axis\d*$/.test(name)) layout[name].range = drawing.layout[name].range;
    const width = drawing.closest(".pair")?.children.length > 1 ? 312 : 655; // px, of 176 mm or half of it
    Plotly.react(drawing, data, printing ? { ...layout, autosize: false, width } : layout, CONFIG);
  }
}
