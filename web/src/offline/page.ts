/** A creature as one HTML file that needs no network: the template with its data. `client.Replay` fills the same one. */

import * as api from "../api/client";
import type { Creature } from "../api/types";
import { isInstalled, kernelBytes } from "../simulate/source";
import { poll } from "../store/polling";
import { DATA, packed } from "./packing";

/** Facts about the creature on the page. */
export interface About {
  title: string;
  /** The address of its share; null without one that others can open. */
  address: string | null;
  /** Null for a motion alone, which the library for notebooks puts into the same page. */
  creature: Creature | null;
  /** A note on parts that the motion leaves out. */
  note?: string;
}

export type AboutCreature = About & { creature: Creature };

const TEMPLATE = "/saved.html";

/** Throws the reason of the signal when it is aborted. */
export async function pageOf(about: AboutCreature, signal: AbortSignal): Promise<Blob> {
  const sha = about.creature.sha256;
  const [template, motion, evaluation, kernel] = await Promise.all([
    fetch(TEMPLATE, { signal }).then((answer) => answer.text()),
    ready(() => api.readMotion(sha), signal),
    ready(() => api.readEvaluation(sha), signal),
    isInstalled ? kernelBytes() : null,
  ]);
  const data = {
    [DATA.about]: forScript(about),
    [DATA.motion]: await packed(motion),
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

/** Ask until the server has made it, or the signal is aborted. */
const ready = <T>(ask: () => Promise<T | null>, signal: AbortSignal) =>
  new Promise<T>((value, reject) => {
    signal.throwIfAborted();
    const end = poll(ask, { value, note: () => {}, error: (message) => reject(new Error(message)) });
    signal.addEventListener("abort", () => {
      end();
      reject(signal.reason as Error);
    });
  });
