import { h, say } from "../dom";
import type { LogSetting, LogSettings } from "../protocol";

interface Kind {
  words: string;
  hint: string;
  /** The values to choose from; without them, the field takes text or a number. */
  options?: string[];
  number?: true;
}

const KINDS: Record<LogSetting, Kind> = {
  columns: { words: "Columns", hint: "gx, gy, gz (names, or numbers from 0)" },
  topic: { words: "Topic", hint: "/imu/data" },
  where: { words: "Only the rows with", hint: "SensorId=1" },
  rate_hz: { words: "Sample rate, Hz", hint: "100", number: true },
  time_column: { words: "Time column", hint: "t" },
  time_unit: { words: "Unit of time", hint: "", options: ["", "s", "ms", "us", "ns", "min", "h"] },
  temp_column: { words: "Temperature column", hint: "temp_c" },
  skip: { words: "Leave out before", hint: "45m, or 12:30:00" },
  until: { words: "Leave out after", hint: "2h, or 14:30:00" },
  gyro_unit: { words: "Gyroscope unit", hint: "dps, rad/s, deg/h" },
  gyro_scale: { words: "Gyroscope scale: one step, in that unit", hint: "1", number: true },
  accel_unit: { words: "Accelerometer unit", hint: "m/s², g, mg" },
  accel_scale: { words: "Accelerometer scale: one step, in that unit", hint: "1", number: true },
  decimal: { words: "Decimal mark", hint: "", options: ["", "point", "comma"] },
};

type Input = HTMLInputElement | HTMLSelectElement;

/** Settings that a log does not state or states wrongly. The page asks for needed ones, and offers the others. */
export class Questions {
  readonly element: HTMLElement;
  readonly #text = h("p", { class: "question", role: "alert" });
  readonly #choices = h("pre", { tabindex: 0, role: "region", "aria-label": "Values to choose from" });
  readonly #fields = new Map<LogSetting, { row: HTMLElement; input: Input }>();
  readonly #details: HTMLDetailsElement;

  constructor(answer: (settings: LogSettings) => void) {
    for (const key of Object.keys(KINDS) as LogSetting[]) this.#fields.set(key, field(key, KINDS[key]));
    const submit = (event: Event) => {
      event.preventDefault();
      answer(this.#settings());
    };
    this.#details = h(
      "details",
      {},
      h("summary", {}, "Correct or add what the log says"),
      h("div", { class: "fields" }, ...[...this.#fields.values()].map(({ row }) => row)),
      h("div", { class: "actions" }, h("button", { type: "submit", class: "primary" }, "Look again")),
    );
    this.element = h(
      "form",
      { class: "card questions", submit, "aria-label": "Settings of the log" },
      this.#text,
      this.#choices,
      this.#details,
    );
  }

  /** Asks a question, and marks the settings that it mentions. */
  ask(text: string, choices: string[], settings: LogSetting[]): void {
    say(this.#text, text);
    say(this.#choices, choices.join("\n"));
    this.#mark(new Set(settings));
    this.#details.open = true;
  }

  /** Offers the settings without a question. */
  offer(): void {
    say(this.#text, "");
    say(this.#choices, "");
    this.#mark(new Set());
    this.#details.open = false;
  }

  reset(): void {
    for (const { input } of this.#fields.values()) input.value = "";
  }

  #mark(asked: ReadonlySet<LogSetting>): void {
    this.#choices.hidden = this.#choices.textContent === "";
    this.#text.hidden = this.#text.textContent === "";
    for (const [key, { row }] of this.#fields) row.classList.toggle("asked", asked.has(key));
  }

  #settings(): LogSettings {
    const given = [...this.#fields].filter(([, { input }]) => input.value.trim() !== "");
    return Object.fromEntries(
      given.map(([key, { input }]) => [key, parsed(key, input.value.trim())]),
    ) as LogSettings;
  }
}

function field(key: LogSetting, { words, hint, options, number }: Kind): { row: HTMLElement; input: Input } {
  const id = `log-${key}`;
  const input = options
    ? h("select", { id }, ...options.map((value) => h("option", { value }, value || "as the log says")))
    : h("input", { id, type: number ? "number" : "text", step: "any", placeholder: hint, autocomplete: "off" });
  return { row: h("div", { class: "field" }, h("label", { for: id }, words), input), input };
}

function parsed(key: LogSetting, text: string): string | number | string[] {
  if (key === "columns")
    return text
      .split(",")
      .map((name) => name.trim())
      .filter((name) => name !== "");
  return KINDS[key].number ? Number(text) : text;
}
