// The best drive in a few figures, always in sight; what is wrong with the spec in its place.

import { button, element } from "./dom.js";

const headline = document.getElementById("headline");
const voice = document.getElementById("said");
const QUIET = 900; // ms without another answer, after which it is said aloud
let speaking = 0;

export function busy() {
  document.documentElement.dataset.state = "busy";
  headline.classList.add("stale");
}

/** Says a new best drive once, and not at every place of a slider. */
function say(text) {
  clearTimeout(speaking);
  speaking = setTimeout(() => { if (voice.textContent !== text) voice.textContent = text; }, QUIET);
}

function put(kind, ...inside) {
  headline.className = kind;
  headline.replaceChildren(...inside);
}

/** What to buy, and what decides; with its closed loop the whole answer is there. */
export function rank(piece, state = "ranked") {
  document.documentElement.dataset.state = state;
  if (piece.machine) return machine(piece);
  const best = piece.sets[0];
  if (!best) {
    put("fail", head("fail", "No drive meets all limits."), facts([["drives considered", count(piece.considered)]]));
    return say("No drive meets all limits.");
  }
  const text = piece.found ? best.label : `No drive meets all limits. The closest: ${best.label}`;
  const shown = [...best.figures];
  shown.push(...piece.loops);
  if (best.tight) shown.push([`tightest: ${best.tight.title}`, best.tight.said]);
  shown.push([`of ${count(piece.considered)}, by ${piece.objective.replaceAll("_", " ")}`, piece.met]);
  put(piece.status, head(piece.status, text), facts(shown));
  return say(`${piece.status}: ${text}`);
}

const count = (value) => value.toLocaleString("en");

function head(status, text) {
  return element("p", { className: "best" }, element("span", { className: `pill ${status}`, textContent: status }), ` ${text}`);
}

function facts(pairs) {
  return element("dl", {}, ...pairs.map(([title, value]) => element("div", {}, element("dt", { textContent: title }), element("dd", { textContent: value }))));
}

const MOST = 6; // axes with their drives

/** The axes of a machine with their drives, first those without one. */
function machine(piece) {
  const without = piece.axes.filter((one) => !one.label), others = piece.axes.filter((one) => one.label);
  const text = `Machine of ${piece.axes.length} axes${without.length ? `, ${without.length} without a drive that meets all limits` : ""}`;
  const shown = [...without, ...others].slice(0, MOST).map((one) => [one.axis, one.label ?? "no drive"]);
  if (piece.axes.length > MOST) shown.push(["and", `${piece.axes.length - MOST} more`]);
  shown.push(...piece.loops.filter(([, said]) => said !== "pass").map(([axis, said]) => [`${axis} in closed loop`, said]));
  put(`${piece.status} several`, head(piece.status, text), facts(shown));
  say(`${piece.status}: ${text}`);
}

/** What is wrong, as the command line prints it, each with a button that shows the place. */
export function wrong(faults, reveal) {
  document.documentElement.dataset.state = "wrong";
  const lines = faults.map((fault) => {
    const line = element("p", { className: "fault" }, fault.said);
    if (fault.line || fault.path.length) line.append(" ", button("show", () => reveal(fault), { aria: { label: `show the place: ${fault.said}` } }));
    return line;
  });
  put("wrong", element("p", { className: "best", textContent: faults.length === 1 ? "The spec has a fault" : `The spec has ${faults.length} faults` }), ...lines);
  say(faults.map((fault) => fault.said).join("; "));
}
