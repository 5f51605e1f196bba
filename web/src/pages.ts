/** The pages, by the word behind `#` in the address. */
export const PAGES = { bench: "Bench", calibrate: "Calibrate", log: "Log", device: "Device" } as const;
export type PageName = keyof typeof PAGES;

/** The page that the address names; Bench if it names none. */
export function named(hash: string): PageName {
  const word = hash.replace(/^#\/?/, "");
  return word in PAGES ? (word as PageName) : "bench";
}
