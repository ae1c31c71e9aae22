// Requests to the server: pieces of an answer as they come.

const address = new URL(".", location.href);
export const tab = crypto.getRandomValues(new Uint32Array(3)).join("-");

/** A file of the server as JSON. */
export async function get(name) {
  const response = await fetch(new URL(name, address), { cache: "no-store" });
  if (!response.ok) throw new Error(`${name}: ${response.status}`);
  return response.json();
}

export async function post(name, body) {
  return fetch(new URL(name, address), { method: "POST", headers: { "content-type": "application/json" }, body: JSON.stringify(body) });
}

const FIRST = new Set(["loop", "report", "export", "compare"]); // before them what is computed ahead gives way
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

async function* answered(job, body, signal) {
  const response = await fetch(new URL(`do/${job}`, address), {
    method: "POST", headers: { "content-type": "application/json" }, body: JSON.stringify({ ...body, tab }), signal,
  });
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
