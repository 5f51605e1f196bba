/** The pages, by the word behind `#` in the address. */
export const PAGES = { bench: "Bench", calibrate: "Calibrate", log: "Log", device: "Device" } as const;
export type PageName = keyof typeof PAGES;

export function named(hash: string): PageName {
  const word = hash.replace(/^#\/?/, "");
  return word in PAGES ? (word as PageName) : "bench";
}
