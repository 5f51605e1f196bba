import { Asking, type Command, type Link, type LinkState } from "./link";
import { storage } from "../storage";
import type { FromLive, Opening, ToLive } from "../worker/messages";

interface Port {
  postMessage(message: ToLive, transfer: Transferable[]): void;
  onmessage: ((event: MessageEvent<FromLive>) => void) | null;
}

const NOT_STARTED = "The worker of this page could not be started. Load the page again.";

/** The session in a worker of this browser. */
export class Inside implements Link {
  onframe: (bytes: ArrayBuffer) => void = () => {};
  onstate: (state: LinkState) => void = () => {};
  /** Called with bytes to write to the serial port of this window. */
  onserial: (bytes: Uint8Array) => void = () => {};
  /** Called when the session no longer reads the port of this window. */
  onrelease: () => void = () => {};
  readonly #asking = new Asking();
  #port: Port | undefined;
  #failed: string | undefined;

  start(): void {
    this.onstate({ is: "connecting" });
    this.#port = "SharedWorker" in globalThis ? this.#join() : this.#own();
    this.#port.onmessage = ({ data }) => this.#heard(data);
    this.tell({ do: "hello", ...storage.calibrations(), open: storage.opening() });
    addEventListener("pagehide", () => this.tell({ do: "bye" }));
    addEventListener("pageshow", (event) => {
      if ((event as PageTransitionEvent).persisted) location.reload();
    });
  }

  ask(command: Command) {
    if (this.#failed !== undefined) return Promise.reject(new Error(this.#failed));
    return this.#asking.ask(command, (text) => this.tell({ do: "ask", text }));
  }

  open(what: Opening): void {
    if (what.is === "twin") storage.keepOpening(what);
    this.tell({ do: "open", what });
  }

  tell(message: ToLive, transfer: Transferable[] = []): void {
    this.#port?.postMessage(message, transfer);
  }

  #join(): Port {
    // the extended lifetime keeps the session over a reload of the only window; closing that window still ends it
    const options = { type: "module", name: "zerorate", extendedLifetime: true } as const;
    const worker = new SharedWorker(new URL("live.js", import.meta.url), options as WorkerOptions);
    worker.onerror = () => this.#fail(NOT_STARTED);
    return worker.port;
  }

  #own(): Port {
    const worker = new Worker(new URL("live.js", import.meta.url), { type: "module" });
    worker.onerror = () => this.#fail(NOT_STARTED);
    return worker;
  }

  #heard(told: FromLive): void {
    if (told.is === "frame") {
      this.#failed = undefined;
      this.onstate({ is: "open" });
      this.onframe(told.bytes);
    } else if (told.is === "answer") this.#asking.answered(told.text);
    else if (told.is === "serial-send") this.onserial(told.bytes);
    else if (told.is === "serial-release") this.onrelease();
    else this.#fail(told.why);
  }

  #fail(why: string): void {
    this.#failed = why;
    this.#asking.gone(why);
    this.onstate({ is: "failed", why });
  }
}
