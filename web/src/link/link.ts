import type { Answer, Reply, Request } from "../protocol";

type Without<T, K extends PropertyKey> = T extends unknown ? Omit<T, K> : never;

/** What can be asked of the session. */
export type Command = Without<Request, "id">;

/** How it is with the way to the session. */
export type LinkState =
  | { is: "connecting" }
  | { is: "open" }
  /** It will be tried again. */
  | { is: "lost" }
  /** The server wants its token. */
  | { is: "locked"; wrong: boolean }
  | { is: "failed"; why: string };

/** The way to the session, wherever it runs. */
export interface Link {
  /** Asks for something; fails with the session's own words. */
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

  /** Nobody will answer any more. */
  gone(why: string): void {
    for (const { fail } of this.#waiting.values()) fail(new Error(why));
    this.#waiting.clear();
  }
}
