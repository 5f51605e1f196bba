import type { Answer, Reply, Request } from "../protocol";

type Without<T, K extends PropertyKey> = T extends unknown ? Omit<T, K> : never;

/** A request to the session, without its number. */
export type Command = Without<Request, "id">;

export type LinkState =
  | { is: "connecting" }
  | { is: "open" }
  /** The connection broke. The page tries to connect again. */
  | { is: "lost" }
  /** The server asks for its token. */
  | { is: "locked"; wrong: boolean }
  | { is: "failed"; why: string };

/** The connection to the session, wherever the session runs. */
export interface Link {
  /** Sends a command. If the session refuses it, the promise is rejected with the session's error text. */
  ask(command: Command): Promise<Reply>;
  onframe: (bytes: ArrayBuffer) => void;
  onstate: (state: LinkState) => void;
  start(): void;
}

/** Requests that wait for their answers. */
export class Asking {
  readonly #waiting = new Map<number, { done: (reply: Reply) => void; fail: (why: Error) => void }>();
  #id = 0;

  ask(command: Command, send: (text: string) => void): Promise<Reply> {
    const id = ++this.#id;
    return new Promise((done, fail) => {
      this.#waiting.set(id, { done, fail });
      send(JSON.stringify({ ...command, id }));
    });
  }

  answered(text: string): void {
    const answer = JSON.parse(text) as Answer;
    const waiting = this.#waiting.get(answer.id);
    this.#waiting.delete(answer.id);
    if ("error" in answer) waiting?.fail(new Error(answer.error));
    else waiting?.done(answer.ok);
  }

  /** Fails all requests, because nobody will answer them. */
  gone(why: string): void {
    for (const { fail } of this.#waiting.values()) fail(new Error(why));
    this.#waiting.clear();
  }
}
