import { describe, expect, it } from "vitest";
import type { Spec } from "../../api/types";
import { schemaErrors, messagesByPath, partOf, valueAt, withChoice } from "./document";
import type { Field, Rows, Section, Union } from "./fields";
import { FORM } from "./schema.fixture";

const part = <F extends Field>(section: Section, path: string) =>
  section.fields.find((field) => field.path === path) as F;

const WORLD = part<Section>(FORM, "world");

describe("a form", () => {
  it("has a section for a referenced object, with its own help", () => {
    expect(WORLD).toMatchObject({ kind: "section", title: "World", help: "A box of fluid." });
  });

  it("has numbers with unit, range and help", () => {
    expect(part(WORLD, "world.width")).toEqual({
      kind: "number",
      path: "world.width",
      title: "Width",
      help: "Along x.",
      whole: true,
      nullable: false,
      unit: "cells",
      range: { low: 16, lowOpen: false, high: 2048, highOpen: false },
    });
    expect(part(WORLD, "world.viscosity")).toMatchObject({ range: { low: 0, lowOpen: true } });
  });

  it("has a number that may be left empty where null is allowed", () => {
    expect(part(WORLD, "world.limit")).toMatchObject({ kind: "number", nullable: true, unit: "m" });
  });

  it("keeps the type of what can be selected", () => {
    expect(part(WORLD, "world.factor")).toMatchObject({ kind: "choice", options: [1, 2] });
    expect(part(WORLD, "world.open")).toMatchObject({ kind: "flag" });
    expect(part(FORM, "experiment")).toMatchObject({ kind: "constant" });
  });

  it("has a section that can be switched on with its defaults where null is allowed", () => {
    expect(part(WORLD, "world.steric")).toMatchObject({ kind: "section", fresh: { strength: 4 } });
    expect(WORLD.fresh).toBeUndefined();
  });

  it("has a part for each word of a union, which begins as its defaults say", () => {
    const union = part<Union>(FORM, "body");
    expect([union.tag, ...union.parts.keys()]).toEqual(["builder", "chain", "line", "worm", "ray"]);
    const chain = union.parts.get("chain")!;
    expect(chain.fresh).toEqual({ builder: "chain", stretch: 1, nodes: 32 });
    expect(chain.help).toBe("A straight filament.");
    expect(chain.fields.map(({ path }) => path)).toEqual(["body.stretch", "body.nodes"]);
    expect(JSON.stringify(union.parts.get("line")!.fresh)).toBe('{"builder":"line","points":[[0,0],[1,1]]}');
    expect(union.parts.get("ray")!.fresh).toEqual({ builder: "ray" });
    expect(partOf(union, { body: { builder: "worm" } })).toBe(union.parts.get("worm"));
    expect(partOf(union, { body: { builder: "unheard of" } })).toBeNull();
  });

  it("has lists of numbers and of words for arrays of them", () => {
    expect(part(FORM, "swimmers")).toMatchObject({ kind: "several", options: ["worm", "ray"] });
    expect(part(FORM, "viscosities")).toMatchObject({ kind: "list", least: 1, most: 3 });
  });

  it("has rows for arrays of objects, and a fresh row from their defaults", () => {
    const rows = part<Rows>(FORM, "axes");
    const fresh = { name: "a", bins: 20, low: null, scale: null };
    expect([rows.least, rows.most, rows.fresh]).toEqual([1, 2, fresh]);
    const row = rows.row(1) as Section;
    const names = ["name", "bins", "low", "scale"];
    expect(row.fields.map(({ path }) => path)).toEqual(names.map((name) => `axes.1.${name}`));
  });

  it("leaves out again what follows from a choice when another is made", () => {
    const rows = part<Rows>(FORM, "axes");
    const row = rows.row(0) as Section;
    const [name, bins, low, scale] = row.fields as [Field, Field, Field, Field];
    expect(row.following).toEqual(["low", "scale"]);
    expect([bins, low, scale]).toMatchObject([{ nullable: false }, { nullable: true }, { nullable: true }]);
    const spec = { axes: [{ name: "a", bins: 4, low: -1, scale: "linear" }] };
    const selected = withChoice(spec, row, name, "b");
    expect(selected).toEqual({ axes: [{ name: "b", bins: 4, low: null, scale: null }] });
    expect(valueAt(withChoice(spec, row, scale, "log10"), "axes.0.low")).toBe(-1);
    expect(valueAt(withChoice(spec, row, bins, 9), "axes.0.low")).toBe(-1);
  });

  it("has rows of parts for arrays of a union, each row of its own kind", () => {
    const rows = part<Rows>(FORM, "emitters");
    expect(rows.fresh).toEqual({ operator: "any" });
    const row = rows.row(2) as Union;
    expect([row.path, row.tag]).toEqual(["emitters.2", "operator"]);
    const selected = row.parts.get("line")!;
    expect(selected.fresh).toEqual({ operator: "line", step: 0.5 });
    expect(selected.fields.map(({ path }) => path)).toEqual(["emitters.2.step"]);
    const spec: Spec = { emitters: [{ operator: "any" }, { operator: "line", step: 0 }] };
    const wrong = schemaErrors(FORM, spec).filter(({ field }) => field.startsWith("emitters"));
    expect(wrong).toEqual([{ field: "emitters.1.step", message: "Needs more than 0." }]);
    const error = { field: "emitters.1.step", message: "no" };
    expect([...messagesByPath([error], FORM, spec).keys()]).toEqual(["emitters.1.step"]);
  });
});
