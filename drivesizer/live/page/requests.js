// Requests to the server: pieces of an answer as they come.

const address = new URL(".", location.href);
export const tab = crypto.getRandomValues(new Uint32Array(3)).join("-");

/** A file of the server as JSON. */
export async function get(name) {
  const response = await fetch(new URL(name, address), { cache: "no-store" });
  if (!response.ok) throw new Error(`${name}: ${response.status}`);
  return response.json();
}

export async function post(name, body, signal) {
  return fetch(new URL(name, address), { method: "POST", headers: { "content-type": "application/json" }, body: JSON.stringify(body), signal });
}

const FIRST = new Set(["loop", "design", "report", "export", "compare"]); // before them what is computed ahead gives way
const ahead = [];

/** What is done before a job that the user waits for, and after it. */
export function whenFree(stop, goOn) { ahead.push({ stop, goOn }); }

/** Pieces of the answer to a job, each as soon as it has come. */
export async function* pieces(job, body, signal) {
  if (!FIRST.has(job)) {
    yield* answered(job, body, signal);
    return;
  }
  for (const each of ahead) each.stop();
  try {
    yield* answered(job, body, signal);
  } finally {
    for (const each of ahead) each.goOn();
  }
}

// -- what takes more than a second: how far it is, how long it still takes, and a button that stops it

const SOON = 1500; // ms after which it is shown
const BESIDE = new Set(["sweep", "rejected"]); // which nobody waits for
const bar = document.getElementById("progress");
let stop = null; // of the job that is shown

bar.lastElementChild.addEventListener("click", () => stop?.());

function shown(said, stopped, value) {
  const [drawn, text] = bar.children;
  if (value === undefined) drawn.removeAttribute("value");
  else drawn.value = value;
  text.textContent = said;
  bar.hidden = false;
  stop = stopped;
}

function far({ done, all }, since, stopped) {
  const left = Math.round(((performance.now() - since) / 1000) * (all / done - 1));
  shown(`${Math.round((100 * done) / all)} %, ${left < 1 ? "less than a second" : `about ${left} s`} left`, stopped, done / all);
}

async function* answered(job, body, signal) {
  const own = new AbortController(), since = performance.now(), stopped = () => own.abort();
  const soon = BESIDE.has(job) ? 0 : setTimeout(() => shown("computing …", stopped), SOON);
  try {
    for await (const piece of received(job, body, AbortSignal.any([own.signal, ...(signal ? [signal] : [])]))) {
      if (piece.kind !== "progress") yield piece;
      else if (soon) far(piece, since, stopped);
    }
  } catch (error) {
    if (!own.signal.aborted) throw error;
    yield { kind: "wrong", lines: ["stopped before it was done; any change starts it again"] };
  } finally {
    clearTimeout(soon);
    if (stop === stopped) bar.hidden = true;
  }
}

async function* received(job, body, signal) {
  const response = await post(`do/${job}`, { ...body, tab }, signal);
  if (!response.ok || !response.body) {
    const said = response.status === 503 ? ["the server has too much to do; try again"] : (await response.json().catch(() => ({}))).lines;
    yield { kind: "wrong", lines: said ?? [`the server refused this (${response.status})`] };
    return;
  }
  const reader = response.body.pipeThrough(new TextDecoderStream()).getReader();
  let rest = "";
  for (;;) {
    const { value, done } = await reader.read();
    if (done) return;
    const lines = (rest + value).split("\n");
    rest = lines.pop();
    for (const line of lines) yield JSON.parse(line);
  }
}

/** All pieces of a job at once; an error where something is wrong. */
export async function whole(job, body, signal) {
  const found = [];
  for await (const piece of pieces(job, body, signal)) {
    if (piece.kind === "wrong") throw new Error(piece.lines.join("; "));
    found.push(piece);
  }
  return found;
}
