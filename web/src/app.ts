import type { Inside } from "./link/inside";
import type { Command, Link } from "./link/link";
import type { Model, Part } from "./model";
import type { Reply } from "./protocol";

export interface App {
  model: Model;
  link: Link;
  /** The same object as `link` if the session runs in this browser; otherwise undefined. */
  inside: Inside | undefined;
  /** Sends a command. If it is refused, shows why and returns undefined. */
  ask(command: Command): Promise<Reply | undefined>;
  /** Shows a message for a moment. */
  tell(text: string, kind?: "said" | "wrong"): void;
}

export interface Page {
  readonly element: HTMLElement;
  /** Shows changes, at most once per animation frame and only while the page is visible. `all`: shows everything. */
  update(changed: ReadonlySet<Part>, all: boolean): void;
  /** Redraws the page after a change of theme or unit. */
  restyle(): void;
  /** Handles a key that was pressed outside of input fields. Returns true if the page uses the key. */
  key?(event: KeyboardEvent): boolean;
}
