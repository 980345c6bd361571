/** Descriptions of the coupling between bodies and fluid, and a badge for results that are not force-free. */

import type { Json, Spec } from "../api/types";
import { number } from "./format";
import { text } from "./text";

export function couplingForm(name: string) {
  const [title, about] = text.forms[name] ?? [name, ""];
  return { title, about, forceFree: name !== "paper" };
}

const asObject = (value: Json | undefined): Spec =>
  value && typeof value === "object" && !Array.isArray(value) ? value : {};

/** True if a coupling cannot exert a net force on a body. */
export const isForceFree = (coupling: Json | undefined) => asObject(coupling).projection !== "none";

export function forceFreeShare(spec: Spec): "all" | "some" | "none" {
  const forms = Array.isArray(spec.forms) ? spec.forms : null;
  if (!forms) return isForceFree(spec.coupling) ? "all" : "none";
  const freeForms = forms.filter((name) => couplingForm(String(name)).forceFree).length;
  if (freeForms === forms.length) return "all";
  return freeForms > 0 ? "some" : "none";
}

export function couplingFacts(coupling: Json | undefined): [string, string][] {
  const { projection, theta_feedback, layers, nu_c, kernel, force_factor, limits } = asObject(coupling);
  const removed = { none: text.freedOfNothing, force: text.netForce }[String(projection)];
  const angles = theta_feedback === 0 ? text.anglesFree : text.anglesFollow;
  const strength = typeof nu_c === "number" ? text.halfStrength(number(nu_c)) : text.unlimited;
  return [
    [text.forcingFreedOf, removed ?? text.netForceAndTorque],
    [text.edgeAngles, angles],
    [text.actuatorStrength, strength],
    [text.forcing, text.layers(layers, force_factor ?? 2)],
    [text.deltaKernel, String(kernel ?? "roma")],
    [text.limits, limits === false ? text.off : text.on],
  ];
}

export function NotForceFree({ some = false }: { some?: boolean }) {
  return (
    <span class="badge not-force-free" title={text.notForceFreeAbout}>
      {some ? text.partlyNotForceFree : text.notForceFree}
    </span>
  );
}
