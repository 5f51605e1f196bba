import { Asking, type Command, type Link, type LinkState } from "./link";
import { type Home, home } from "../home";

/** First and longest waiting time before the page connects again, s. */
const FIRST_S = 0.25;
const LONGEST_S = 8;

/** The session of `zerorate serve`, over a WebSocket that is opened again whenever it breaks. */
export class Served implements Link {
  onframe: (bytes: ArrayBuffer) => void = () => {};
  onstate: (state: LinkState) => void = () => {};
  readonly #asking = new Asking();
  #socket: WebSocket | undefined;
  #wait_s = FIRST_S;

  start(): void {
    void this.#enter();
  }

  ask(command: Command) {
    const socket = this.#socket;
    if (socket?.readyState !== WebSocket.OPEN) return Promise.reject(new Error("The server cannot be reached now."));
    return this.#asking.ask(command, (text) => socket.send(text));
  }

  /** Gives the token to the server, which answers with a cookie. */
  async unlock(token: string): Promise<void> {
    const answer = await fetch("token", {
      method: "POST",
      body: token,
      headers: { "content-type": "text/plain" },
    }).catch(() => undefined);
    if (answer?.ok) this.#connect();
    else this.onstate({ is: "locked", wrong: answer !== undefined });
  }

  async #enter(): Promise<void> {
    const now = await home().catch((): Home | undefined => undefined);
    if (now === undefined || now.home !== "served") this.#again();
    else if (!now.token_needed) this.#connect();
    else await this.#unlockFromAddress();
  }

  async #unlockFromAddress(): Promise<void> {
    const token = new URLSearchParams(location.hash.slice(1)).get("token");
    if (token === null) return this.onstate({ is: "locked", wrong: false });
    history.replaceState(null, "", `${location.pathname}#bench`);
    await this.unlock(token);
  }

  #connect(): void {
    this.onstate({ is: "connecting" });
    const socket = new WebSocket(new URL("ws", document.baseURI.replace(/^http/, "ws").replace(/#.*/, "")));
    socket.binaryType = "arraybuffer";
    socket.onopen = () => this.onstate({ is: "open" });
    socket.onmessage = ({ data }: MessageEvent<ArrayBuffer | string>) => this.#heard(data);
    socket.onclose = () => {
      this.#asking.gone("The server went away before it answered. The command may have been executed all the same.");
      this.#again();
    };
    this.#socket = socket;
  }

  #heard(data: ArrayBuffer | string): void {
    if (typeof data === "string") return this.#asking.answered(data);
    this.#wait_s = FIRST_S;
    this.onframe(data);
  }

  #again(): void {
    this.onstate({ is: "lost" });
    setTimeout(() => void this.#enter(), this.#wait_s * 1000);
    this.#wait_s = Math.min(2 * this.#wait_s, LONGEST_S);
  }
}
