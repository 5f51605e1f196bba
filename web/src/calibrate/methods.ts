import type { MethodName } from "../protocol";

/** A way to calibrate, in plain words. */
export interface Method {
  name: MethodName;
  title: string;
  what: string;
  when: string;
}

export const METHODS: readonly Method[] = [
  {
    name: "an1042",
    title: "Application note",
    what:
      "The procedure of AN-1042 to the letter: the rate at two temperatures while the part warms itself, then a " +
      "long mean. A line over temperature.",
    when: "Take it where the result must be that of the note, or where a controller does the same by itself.",
  },
  {
    name: "warmup",
    title: "Warm-up",
    what:
      "Every sample of one warm-up from cold. A curve that bends where the part bends, with its uncertainty at " +
      "each temperature.",
    when: "Take it for everything else that is done on a table: it leaves less than the note's line.",
  },
  {
    name: "cycle",
    title: "Warm and cool",
    what:
      "Every sample while the part warms and cools again, by a fan, a plate or a heater that is switched off. " +
      "Drift is told from temperature.",
    when: "Take it when you can cool the part as well: it leaves the least, and it shows a hysteresis.",
  },
];

export function titleOf(name: MethodName): string {
  return METHODS.find((method) => method.name === name)?.title ?? name;
}
