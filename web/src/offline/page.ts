/** A creature as one HTML file that needs no network: the template with its data. */

import * as api from "../api/client";
import type { Creature } from "../api/types";
import { decodeReplay } from "../decode/replay";
import { isInstalled, kernelBytes } from "../simulate/source";
import { poll } from "../store/polling";
import { packMotion } from "./motion";
import { DATA, packed } from "./packing";

/** What the page says about the creature. */
export interface About {
  title: string;
  /** The address of its share; null without one that others can open. */
  address: string | null;
  creature: Creature;
}

const TEMPLATE = "/saved.html";

/** Throws what the signal says when it is aborted. */
export async function pageOf(about: About, signal: AbortSignal): Promise<Blob> {
  const sha = about.creature.sha256;
  const [template, replay, evaluation, kernel] = await Promise.all([
    fetch(TEMPLATE, { signal }).then((answer) => answer.text()),
    ready(() => api.readReplay(sha), signal),
    ready(() => api.readEvaluation(sha), signal),
    isInstalled ? kernelBytes() : null,
  ]);
  const data = {
    [DATA.about]: forScript(about),
    [DATA.motion]: await packed(packMotion(decodeReplay(replay))),
    [DATA.evaluation]: await packed(evaluation),
    ...(kernel && { [DATA.kernel]: await packed(kernel) }),
  };
  signal.throwIfAborted();
  return new Blob([filled(template, about.title, data)], { type: "text/html" });
}

/** The template with a title and elements of data, which no browser runs. */
export function filled(template: string, title: string, data: Record<string, string>): string {
  const elements = Object.entries(data).map(
    ([id, content]) => `<script type="text/plain" id="${id}">${content}</script>`,
  );
  const [head, body, end, ...more] = template.split(/<!--(?:title|data)-->/);
  if (end === undefined || more.length > 0)
    throw new Error("saved.html needs one title and one place for data");
  return [head, escaped(title), body, elements.join("\n"), end].join("");
}

/** JSON that cannot end the element around it. */
export const forScript = (value: unknown) => JSON.stringify(value).replaceAll("<", "\\u003c");

const escaped = (text: string) => text.replaceAll("&", "&amp;").replaceAll("<", "&lt;");

/** Ask until the server has made it, or nobody wants it. */
const ready = <T>(ask: () => Promise<T | null>, signal: AbortSignal) =>
  new Promise<T>((value, reject) => {
    signal.throwIfAborted();
    const end = poll(ask, { value, note: () => {}, error: (message) => reject(new Error(message)) });
    signal.addEventListener("abort", () => {
      end();
      reject(signal.reason as Error);
    });
  });
