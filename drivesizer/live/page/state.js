// What the page edits: the text of the spec, how it came about, and how it is kept.

const _LONGEST = 200; // texts that can be gone back to
const _ONE = 900; // ms within which changes of one figure are one step back

export const state = { text: "", saved: "", mark: null, name: "robot.yaml", data: null, faults: [], past: [], future: [], sliders: [] };
const watchers = new Set();
let last = { what: "", at: 0 };

export function watch(watcher) { watchers.add(watcher); }

export function changed() { for (const watcher of watchers) watcher(); }

/** Takes a new text; `what` names the figure that is moved, so that a drag is one step back. */
export function put(text, what = "") {
  if (text === state.text) return;
  const now = performance.now();
  const same = what && what === last.what && now - last.at < _ONE;
  if (!same) {
    state.past.push(state.text);
    if (state.past.length > _LONGEST) state.past.shift();
  }
  last = { what, at: now };
  state.future = [];
  state.text = text;
  changed();
}

export function undo() { step(state.past, state.future); }
export function redo() { step(state.future, state.past); }

function step(from, to) {
  if (!from.length) return;
  to.push(state.text);
  state.text = from.pop();
  last = { what: "", at: 0 };
  changed();
}

// -- the state in the address: a reload keeps it, and a link holds it

async function through(stream, bytes) {
  return new Uint8Array(await new Response(new Blob([bytes]).stream().pipeThrough(stream)).arrayBuffer());
}

export async function packed() {
  const whole = JSON.stringify({ text: state.text, mark: state.mark, sliders: state.sliders.map(({ path, whole, low, high }) => ({ path, whole, low, high })) });
  const bytes = await through(new CompressionStream("deflate-raw"), new TextEncoder().encode(whole));
  return bytes.toBase64({ alphabet: "base64url", omitPadding: true });
}

export async function unpacked(hash) {
  const bytes = Uint8Array.fromBase64(hash, { alphabet: "base64url" });
  const found = JSON.parse(new TextDecoder().decode(await through(new DecompressionStream("deflate-raw"), bytes)));
  if (typeof found.text !== "string" || !Array.isArray(found.sliders)) throw new Error("no state");
  return found;
}
