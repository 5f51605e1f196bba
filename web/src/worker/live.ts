// Runs the session: one for all windows if the browser has shared workers, otherwise one for each window.

import initFirst, { FirstLook } from "../../gen/zerorate_first";
import type { LiveSession } from "../../gen/zerorate_live";
import { serveFile } from "./file";
import type { FromLive, Opening, ToLive } from "./messages";

/** The connection to a window, which both kinds of worker have. */
interface Window {
  postMessage(told: FromLive, transfer?: Transferable[]): void;
  onmessage: ((event: MessageEvent<ToLive>) => void) | null;
}

/** Time between two calls in which the session works, ms: 30 frames per second. */
const TURN_MS = 33;
/** Time for reading samples in such a call, ms. The rest is for requests of the windows. */
const BUDGET_MS = 25;

type Hello = Extract<ToLive, { do: "hello" }>;

const windows = new Set<Window>();
let serial: Window | undefined;
let session: LiveSession | undefined;
/** The preview of the twin by the small first module, until there is a session. */
let look: FirstLook | undefined;
let unusable: string | undefined;

const ready = initFirst({ module_or_path: new URL("zerorate_first_bg.wasm", import.meta.url) });
const words = (why: unknown) => (why instanceof Error ? why.message : String(why));

function tellFrame(window: Window, bytes: Uint8Array): void {
  const copy = bytes.slice().buffer;
  window.postMessage({ is: "frame", bytes: copy }, [copy]);
}

/** Loads the module of the session. The small first module is already loaded by then, and may show the twin. */
async function whole() {
  const live = await import("../../gen/zerorate_live");
  await live.default({ module_or_path: new URL("zerorate_live_bg.wasm", import.meta.url) });
  return live.LiveSession;
}

/** Opens a recording, with the module that reads them. If the file is not a recording, the file before it stays in place. */
async function replay(file: File): Promise<LiveSession> {
  const readers = await import("../../gen/zerorate_replay");
  await readers.default({ module_or_path: new URL("zerorate_replay_bg.wasm", import.meta.url) });
  const before = serveFile(file);
  try {
    // the same class, from a larger module
    return readers.LiveSession.of_replay(file.name, file.size) as unknown as LiveSession;
  } catch (why) {
    before();
    throw why;
  }
}

async function begin(what: Opening): Promise<LiveSession> {
  if (what.is === "capture") return replay(what.file);
  const live = await whole();
  return what.is === "twin" ? live.of_twin(what.keys) : live.of_bridge();
}

/** Opens another device. Calibrations stay on file, and the applied one stays applied if it fits the device. */
async function instead(before: LiveSession, what: Opening): Promise<LiveSession> {
  if (what.is === "twin") before.use_twin(what.keys);
  else if (what.is === "serial") before.use_bridge();
  else {
    const after = await replay(what.file);
    handOver(before, after);
    before.free();
    return after;
  }
  return before;
}

function handOver(before: LiveSession, after: LiveSession): void {
  try {
    take(after, before.calibrations(), before.applied() ?? null);
  } catch (why) {
    after.note(`The calibration is no longer applied: ${words(why)}`);
  }
  if (before.is_calibrating()) after.note("The calibration ended without a result, because a recording was opened");
}

/** Opens the first device. If that fails, opens the twin, with a notice that states the reason. */
async function first(what: Opening): Promise<LiveSession> {
  try {
    return await begin(what);
  } catch (why) {
    if (why instanceof WebAssembly.RuntimeError) throw why;
    const twin = (await whole()).of_twin("");
    twin.cannot_open(words(why));
    return twin;
  }
}

/** Opens the device that a window asks for. A bridge is at that window's port. On failure, the old device stays. */
async function open(window: Window, what: Opening): Promise<void> {
  try {
    session = session === undefined ? await begin(what) : await instead(session, what);
  } catch (why) {
    if (session === undefined || why instanceof WebAssembly.RuntimeError) throw why;
    session.cannot_open(words(why));
    return;
  }
  if (serial !== window) serial?.postMessage({ is: "serial-release" });
  serial = what.is === "serial" ? window : undefined;
  for (const one of windows) tellFrame(one, session.snapshot());
}

/** Adds calibrations to a session, except those that it refuses, and applies the one that was applied before. */
function take(open: LiveSession, calibrations: string[], applied: string | null): void {
  for (const toml of calibrations) {
    try {
      open.add_calibration(toml);
    } catch (why) {
      console.warn(words(why));
    }
  }
  if (applied !== null && calibrations.length > 0) open.apply(applied);
}

/** Shows the preview of the twin. A page with stored calibrations needs none: its cache has the session's module. */
function lookFirst(window: Window, said: Hello): void {
  if (said.open.is !== "twin" || said.calibrations.length > 0) return;
  try {
    look ??= new FirstLook(said.open.keys);
    tellFrame(window, look.snapshot());
  } catch {
    // the session will report the reason
  }
}

/** Lets the session continue at the time up to which the first module has shown the twin. */
function goOn(open: LiveSession): void {
  if (look !== undefined) open.catch_up(look.shown_s());
  look?.free();
  look = undefined;
}

async function hello(window: Window, said: Hello): Promise<void> {
  windows.add(window);
  if (session === undefined) {
    lookFirst(window, said);
    const opened = await first(said.open);
    goOn(opened);
    session = opened;
    serial = said.open.is === "serial" ? window : undefined;
    try {
      take(session, said.calibrations, said.applied);
    } catch (why) {
      console.warn(words(why));
    }
  }
  tellFrame(window, session.snapshot());
}

async function hear(window: Window, said: ToLive): Promise<void> {
  if (said.do === "hello") await hello(window, said);
  else if (said.do === "open") await open(window, said.what);
  else if (said.do === "bye") leave(window);
  else if (session === undefined) return;
  else if (said.do === "ask") window.postMessage({ is: "answer", text: session.ask(said.text) });
  // this window's port is no longer read
  else if (window !== serial) return;
  else if (said.do === "serial-bytes") session.received(said.bytes);
  else session.unplugged(said.why);
  send();
}

function leave(window: Window): void {
  windows.delete(window);
  if (window !== serial) return;
  serial = undefined;
  session?.unplugged("its window was closed");
}

function send(): void {
  const bytes = serial === undefined ? undefined : session?.to_send();
  if (bytes !== undefined && bytes.length > 0) serial?.postMessage({ is: "serial-send", bytes });
}

/** Reports that there is no session. A module that trapped does not run again. */
function fail(why: unknown): void {
  session = look = undefined;
  unusable = why instanceof WebAssembly.RuntimeError ? "The session broke down. Load the page again." : words(why);
  for (const window of windows) window.postMessage({ is: "failed", why: unusable });
}

function turn(): void {
  const shown = session ?? look;
  if (shown === undefined) return;
  try {
    shown.turn(BUDGET_MS);
    send();
    const frame = shown.frame();
    if (frame !== undefined) for (const window of windows) tellFrame(window, frame);
  } catch (why) {
    fail(why);
  }
}

/** Completes after the last request. Requests are handled one by one, so that a session is opened only once. */
let heard: Promise<void> = ready.then(() => {});

async function answer(window: Window, said: ToLive): Promise<void> {
  try {
    await ready;
    if (unusable === undefined) await hear(window, said);
    else window.postMessage({ is: "failed", why: unusable });
  } catch (why) {
    if (why instanceof WebAssembly.RuntimeError) fail(why);
    else window.postMessage({ is: "failed", why: words(why) });
  }
}

function connect(window: Window): void {
  window.onmessage = ({ data }) => {
    heard = heard.catch(() => {}).then(() => answer(window, data));
  };
}

setInterval(turn, TURN_MS);
if ("SharedWorkerGlobalScope" in self) {
  (self as unknown as SharedWorkerGlobalScope).onconnect = ({ ports }) => {
    for (const port of ports) connect(port);
  };
} else connect(self as unknown as DedicatedWorkerGlobalScope);
