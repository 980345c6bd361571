/** For tests: the experiments of the server and their presets, and a form with every kind of field. */

import { inject } from "vitest";
import type { Experiment } from "../../api/types";
import { formOf } from "./fields";

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

export const FORM = formOf({
  description: "A run.",
  $defs: {
    World: {
      type: "object",
      description: "A box of fluid.",
      required: ["width", "viscosity", "magic", "factor", "open"],
      properties: {
        width: { type: "integer", minimum: 16, maximum: 2048, unit: "cells", description: "Along x." },
        viscosity: { type: "number", exclusiveMinimum: 0, maximum: 2 },
        limit: { anyOf: [{ type: "number", minimum: 0 }, { type: "null" }], default: null, unit: "m" },
        magic: { type: "string", enum: ["capped", "fixed"] },
        factor: { type: "integer", enum: [1, 2] },
        open: { type: "boolean" },
        steric: { anyOf: [{ $ref: "#/$defs/Steric" }, { type: "null" }], default: null },
      },
    },
    Steric: {
      type: "object",
      properties: { strength: { type: "number", default: 4, maximum: 20 } },
    },
    Chain: {
      type: "object",
      description: "A straight filament.",
      properties: {
        stretch: { type: "number", default: 1 },
        builder: { const: "chain", default: "chain", type: "string" },
        nodes: { type: "integer", default: 32, minimum: 3 },
      },
    },
    Line: {
      type: "object",
      properties: {
        builder: { const: "line", type: "string" },
        points: {
          type: "array",
          minItems: 2,
          items: { type: "array", prefixItems: [{ type: "number" }, { type: "number" }] },
        },
      },
    },
    Known: {
      type: "object",
      properties: { builder: { enum: ["worm", "ray"], type: "string" } },
    },
    Axis: {
      type: "object",
      required: ["name"],
      properties: {
        name: { enum: ["a", "b"] },
        bins: { type: "integer", default: 20 },
        low: { type: "number", minimum: -5 },
        scale: { enum: ["log10", "linear"], type: "string" },
      },
    },
    Line2: {
      type: "object",
      properties: {
        operator: { const: "line", default: "line", type: "string" },
        step: { type: "number", default: 0.5, exclusiveMinimum: 0 },
      },
    },
    Any: {
      type: "object",
      properties: { operator: { const: "any", default: "any", type: "string" } },
    },
  },
  properties: {
    experiment: { const: "quality-diversity", type: "string" },
    world: { $ref: "#/$defs/World", default: {} },
    body: {
      oneOf: [{ $ref: "#/$defs/Chain" }, { $ref: "#/$defs/Line" }, { $ref: "#/$defs/Known" }],
    },
    swimmers: { type: "array", items: { enum: ["worm", "ray"], type: "string" }, minItems: 1 },
    viscosities: {
      type: "array",
      items: { type: "number", minimum: 0.001, maximum: 2 },
      minItems: 1,
      maxItems: 3,
    },
    axes: { type: "array", items: { $ref: "#/$defs/Axis" }, minItems: 1, maxItems: 2 },
    emitters: {
      type: "array",
      default: [],
      items: { oneOf: [{ $ref: "#/$defs/Any" }, { $ref: "#/$defs/Line2" }] },
      minItems: 1,
      maxItems: 3,
    },
  },
});
