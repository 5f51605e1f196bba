import type { Inside } from "./link/inside";
import type { Command, Link } from "./link/link";
import type { Model, Part } from "./model";
import type { Reply } from "./protocol";

/** What every page works with. */
export interface App {
  model: Model;
  link: Link;
  /** The same, where the session runs in this browser. */
  inside: Inside | undefined;
  /** Asks, and says why where it is refused; undefined then. */
  ask(command: Command): Promise<Reply | undefined>;
  /** Says something for a moment. */
  tell(text: string, kind?: "said" | "wrong"): void;
}

/** One of the four pages. */
export interface Page {
  readonly element: HTMLElement;
  /** What is new, at most once a picture and only while the page is seen; `all` when it comes into view. */
  update(changed: ReadonlySet<Part>, all: boolean): void;
  /** The theme or the unit changed. */
  restyle(): void;
  /** A key that no field took; whether the page took it. */
  key?(event: KeyboardEvent): boolean;
}
