import type { MethodName } from "../protocol";

export interface Method {
  name: MethodName;
  title: string;
  what: string;
  when: string;
  /** The preparation before the start. */
  before: readonly string[];
}

const ON_A_TABLE = [
  "Fix the sensor to something that does not move: a heavy table, away from fans and footsteps.",
  "Start cold: leave the sensor off for an hour, then switch it on and start at once.",
  "Supply it from a linear +5 V supply; a switching supply shifts its bias.",
  "Do not touch it until this page says that the calibration is done.",
];

export const METHODS: readonly Method[] = [
  {
    name: "an1042",
    title: "Application note",
    what:
      "Follows AN-1042 to the letter: it measures the rate at two temperatures while the sensor warms itself, then " +
      "averages for a while. The result is a straight line over temperature.",
    when: "Take it if you need the result of the application note, or if a controller follows the same note.",
    before: ON_A_TABLE,
  },
  {
    name: "warmup",
    title: "Warm-up",
    what:
      "Uses every sample of one warm-up from cold. The result is a curve over temperature, with its uncertainty at " +
      "each temperature.",
    when: "Take it unless you have a reason for another one: on a table, it leaves less error than the note’s line.",
    before: ON_A_TABLE,
  },
  {
    name: "cycle",
    title: "Warm and cool",
    what:
      "Uses every sample while the sensor warms and cools again, by a fan, a plate or a heater that is switched " +
      "off. This tells drift from temperature.",
    when: "Take it if you can also cool the sensor: it leaves the least error on a table, and it shows hysteresis.",
    before: ON_A_TABLE,
  },
  {
    name: "chamber",
    title: "Chamber",
    what:
      "Uses every sample over all temperatures at which the sensor will work. You set a chamber, an oven or a " +
      "fridge by hand, as this page tells you.",
    when: "Take it if the sensor will be colder or warmer than on a table, where the other methods extrapolate.",
    before: [
      "Fix the sensor to the floor of the chamber, on something that damps the vibration of the fan.",
      "Supply it from a linear +5 V supply outside. Lead the cables through the port, and close the port.",
      "Set the chamber’s own limit switch: it protects the sensor.",
      "Stay near: this page says what to set and when, and waits until the sensor itself has settled.",
    ],
  },
];

/** The method that is selected first, because it suits everybody who has no reason to take another one. */
export const PRESELECTED: Method = METHODS.find((method) => method.name === "warmup")!;

/** The text about closing the page during a calibration. `inside` is true if the session runs in this browser. */
export function meanwhile(inside: boolean): string {
  if (!inside) return "The page may be closed meanwhile: the session goes on without it.";
  return "Keep this page open and the computer awake: the session runs in this browser, and ends with it.";
}

export function titleOf(name: MethodName): string {
  return METHODS.find((method) => method.name === name)?.title ?? name;
}
