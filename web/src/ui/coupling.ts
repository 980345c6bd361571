/** In which form bodies and fluid are coupled, in words. */

import type { Json, Spec } from "../api/types";
import { number } from "./format";

export interface Form {
  title: string;
  about: string;
  free: boolean;
}

/** The forms of a sweep, by their names in a spec. */
export const FORMS: Record<string, Form> = {
  ours: {
    title: "Ours",
    about: "Force- and torque-free; one actuator strength for all.",
    free: true,
  },
  strong: {
    title: "Ours, tireless",
    about: "Force- and torque-free; actuators of unlimited strength.",
    free: true,
  },
  paper: {
    title: "The paper’s",
    about: "Two layers, free edge angles, as in the paper.",
    free: false,
  },
};

export const NOT_FREE =
  "In this form a body and the fluid need not push each other equally: " +
  "part of its swimming can come from the solver.";

export function formOf(name: string): Form {
  return FORMS[name] ?? { title: name, about: "", free: true };
}

const part = (value: Json | undefined): Spec =>
  value && typeof value === "object" && !Array.isArray(value) ? value : {};

/** Whether a body cannot push itself, as far as a coupling says. */
export const isForceFree = (coupling: Json | undefined) => part(coupling).projection !== "none";

/** Whether everything that a run simulates is force-free, some of it, or nothing. */
export function forceFreeShare(spec: Spec): "all" | "some" | "none" {
  const forms = Array.isArray(spec.forms) ? spec.forms : null;
  if (!forms) return isForceFree(spec.coupling) ? "all" : "none";
  const free = forms.filter((name) => formOf(String(name)).free).length;
  if (free === forms.length) return "all";
  return free > 0 ? "some" : "none";
}

/** The coupling of a creature as rows of words. */
export function couplingFacts(coupling: Json | undefined): [string, string][] {
  const { projection, theta_feedback, layers, nu_c, kernel, force_factor, limits } = part(coupling);
  const free = { none: "nothing: not force-free", force: "net force" }[String(projection)];
  const angles = theta_feedback === 0 ? "free, as in the paper" : "follow the geometry";
  const strength = typeof nu_c === "number" ? `half at ν = ${number(nu_c)}` : "unlimited";
  return [
    ["Forcing freed of", free ?? "net force and torque"],
    ["Edge angles", angles],
    ["Actuator strength", strength],
    ["Forcing", `${layers === 2 ? "two layers" : "one layer"}, factor ${force_factor ?? 2}`],
    ["Delta kernel", String(kernel ?? "peskin")],
    ["Limits", limits === false ? "off" : "on"],
  ];
}
