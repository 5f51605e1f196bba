import type { App } from "./app";
import { button, h, save } from "./dom";
import { FORMS, type Form } from "./protocol";

export function downloads(app: App, calibration: string): HTMLElement {
  const hand = async (form: Form) => {
    const reply = await app.ask({ do: "download", calibration, form });
    if (reply && "media_type" in reply) save(reply.name, reply.media_type, reply.text);
  };
  return h(
    "div",
    { class: "downloads", role: "group", "aria-label": "Download" },
    ...FORMS.map(([form, words]) =>
      button(words, () => void hand(form), { class: "small", "aria-label": `Download as ${words}` }),
    ),
  );
}
