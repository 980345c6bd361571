/** The experiments of the server and their presets, for tests. */

import { inject } from "vitest";
import type { Experiment } from "../../api/types";

declare module "vitest" {
  interface ProvidedContext {
    experiments: Experiment[];
  }
}

export const EXPERIMENTS = inject("experiments");

export const PRESETS = EXPERIMENTS.flatMap((one) =>
  one.presets.map((preset) => [`${one.experiment}/${preset.name}`, one, preset] as const),
);

export const experiment = (name: string) => EXPERIMENTS.find((one) => one.experiment === name)!;
