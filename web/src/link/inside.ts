import { Asking, type Link, type LinkState, type Wish } from "./link";
import { kept } from "../kept";
import type { FromLive, Opening, ToLive } from "../worker/messages";

interface Port {
  postMessage(message: ToLive, transfer: Transferable[]): void;
  onmessage: ((event: MessageEvent<FromLive>) => void) | null;
}

/** The session in a worker of this browser. */
export class Inside implements Link {
  onframe: (bytes: ArrayBuffer) => void = () => {};
  onstate: (state: LinkState) => void = () => {};
  /** Bytes for the serial port of this window. */
  onserial: (bytes: Uint8Array) => void = () => {};
  /** The port of this window is read no more. */
  onrelease: () => void = () => {};
  /** Whether this window has the port that the session reads. */
  hasPort = false;
  /** Whether the session outlives this window. */
  readonly shared = "SharedWorker" in globalThis;
  readonly #asking = new Asking();
  #port: Port | undefined;

  start(): void {
    this.onstate({ is: "connecting" });
    this.#port = this.shared ? this.#join() : this.#own();
    this.#port.onmessage = ({ data }) => this.#heard(data);
    this.tell({ do: "hello", ...kept.calibrations(), open: kept.opening() });
    addEventListener("pagehide", () => this.tell({ do: "bye" }));
    addEventListener("pageshow", (event) => {
      if ((event as PageTransitionEvent).persisted) location.reload();
    });
  }

  ask(wish: Wish) {
    return this.#asking.ask(wish, (text) => this.tell({ do: "ask", text }));
  }

  /** Opens another device. */
  open(what: Opening): void {
    if (what.is === "twin") kept.keepOpening(what);
    this.tell({ do: "open", what });
  }

  tell(message: ToLive, transfer: Transferable[] = []): void {
    this.#port?.postMessage(message, transfer);
  }

  #join(): Port {
    const options = { type: "module", name: "zerorate", extendedLifetime: true } as const;
    const worker = new SharedWorker(new URL("live.js", import.meta.url), options as WorkerOptions);
    worker.onerror = () => this.onstate({ is: "failed", why: "the worker of this page could not be started" });
    return worker.port;
  }

  #own(): Port {
    const worker = new Worker(new URL("live.js", import.meta.url), { type: "module" });
    worker.onerror = () => this.onstate({ is: "failed", why: "the worker of this page could not be started" });
    return worker;
  }

  #heard(told: FromLive): void {
    if (told.is === "frame") {
      this.onstate({ is: "open" });
      this.onframe(told.bytes);
    } else if (told.is === "answer") this.#asking.answered(told.text);
    else if (told.is === "serial-send") this.onserial(told.bytes);
    else if (told.is === "serial-release") this.onrelease();
    else this.onstate({ is: "failed", why: told.why });
  }
}
