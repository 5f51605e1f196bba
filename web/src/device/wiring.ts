import { h, svg, table } from "../dom";

/** The pins of the part that a host needs (F-11), and their names at the host (F-15). */
const WIRES: readonly (readonly [string, string, string, string])[] = [
  ["16", "SCLK", "SCLK", "clock, mode 3, at most 10 MHz"],
  ["14", "SDI", "MOSI", "host to part"],
  ["12", "SDO", "MISO", "part to host, 5 V: shift it for 3.3 V"],
  ["8", "CS", "CS", "chip select, active low"],
  ["10", "RDY", "IRQ", "data ready, falling edge; 5 V as well"],
  ["11, 13, 15", "VDD", "+5 V", "linear supply"],
  ["17, 19–22", "GND", "GND", "ground"],
];
const ROW = 30;
const TOP = 50;

const CARE =
  "No source states the logic levels of the part, which runs from 5 V. Assume that SDO and RDY swing to 5 V, and put a " +
  "level shifter before a 3.3 V host. " +
  "Use ribbon cable up to 12 inches, and shielded twisted pairs beyond. Tie the self-test pins 1–7 and 9 together. " +
  "Drill holes under the mating pads, so that the pins do not bottom out, which would shift the bias.";

export function wiring(): HTMLElement {
  const numbers = table(
    "Wiring",
    ["Pin", "Part", "Host", "What"],
    WIRES.map((row) => [...row]),
  );
  return h("div", { class: "two wired" }, picture(), h("div", {}, numbers, h("p", { class: "note" }, CARE)));
}

function picture(): Element {
  const height = ROW * WIRES.length + TOP - 14;
  const box = (x: number, width: number) => svg("rect", { class: "box", x, y: 4, width, height, rx: 8 });
  const label = "Wiring of the part to a host; the table says the same";
  return svg(
    "svg",
    { viewBox: `0 0 420 ${height + 8}`, role: "img", "aria-label": label, class: "wiring" },
    box(4, 176),
    box(290, 126),
    svg("text", { x: 18, y: 27, class: "head" }, "ADIS16130"),
    svg("text", { x: 304, y: 27, class: "head" }, "Host"),
    ...WIRES.flatMap(wire),
  );
}

function wire([pins, part, host]: (typeof WIRES)[number], index: number): SVGElement[] {
  const y = TOP + index * ROW;
  const pin = (x: number) => svg("circle", { class: "pin", cx: x, cy: y, r: 4 });
  return [
    svg("path", { class: `wire w${index}`, d: `M180 ${y}H290` }),
    pin(180),
    pin(290),
    svg("text", { x: 18, y: y + 4, class: "small" }, pins),
    svg("text", { x: 168, y: y + 4, class: "end" }, part),
    svg("text", { x: 304, y: y + 4 }, host),
  ];
}
