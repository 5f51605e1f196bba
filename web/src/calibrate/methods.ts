import type { MethodName } from "../protocol";

/** A way to calibrate, in plain words. */
export interface Method {
  name: MethodName;
  title: string;
  what: string;
  when: string;
  /** What has to be so before it starts. */
  before: readonly string[];
}

const ON_A_TABLE = [
  "Fix the part to something that does not move: a heavy table, no fan, no feet.",
  "Let it be cold: off for half an hour, then on just now.",
  "Feed it from a linear +5 V supply; a switching one shifts its bias.",
  "Leave it alone until this page says that it is done.",
];

export const METHODS: readonly Method[] = [
  {
    name: "an1042",
    title: "Application note",
    what:
      "The procedure of AN-1042 to the letter: the rate at two temperatures while the part warms itself, then a " +
      "long mean. A line over temperature.",
    when: "Take it where the result must be that of the note, or where a controller does the same by itself.",
    before: ON_A_TABLE,
  },
  {
    name: "warmup",
    title: "Warm-up",
    what:
      "Every sample of one warm-up from cold. A curve that bends where the part bends, with its uncertainty at " +
      "each temperature.",
    when: "Take it for everything else that is done on a table: it leaves less than the note's line.",
    before: ON_A_TABLE,
  },
  {
    name: "cycle",
    title: "Warm and cool",
    what:
      "Every sample while the part warms and cools again, by a fan, a plate or a heater that is switched off. " +
      "Drift is told from temperature.",
    when: "Take it when you can cool the part as well: it leaves the least, and it shows a hysteresis.",
    before: ON_A_TABLE,
  },
  {
    name: "chamber",
    title: "Chamber",
    what:
      "Every sample over the temperatures that the part will see. You set a chamber, an oven or a fridge by hand, " +
      "as this page tells you.",
    when: "Take it where the part will be colder or warmer than on a table: every other method extrapolates there.",
    before: [
      "Fix the part to the floor of the chamber, on something that damps its fan.",
      "Feed it from a linear +5 V supply outside; lead the cables through the port, and close it.",
      "Set the chamber’s own limit switch: it is what protects the part.",
      "Stay near: this page says when to set what, and waits until the part itself has settled.",
    ],
  },
];

/** What becomes of the session without its page; `inside`: it runs in this browser. */
export function meanwhile(inside: boolean): string {
  if (!inside) return "The page may be closed meanwhile: the session goes on without it.";
  return "Keep this page open and the computer awake: the session runs in this browser, and ends with it.";
}

export function titleOf(name: MethodName): string {
  return METHODS.find((method) => method.name === name)?.title ?? name;
}
