import { describe, expect, it } from "vitest";
import type { Json } from "../../api/types";
import { valueAt, withValue } from "./document";
import { type Union, formOf } from "./fields";
import { experiment } from "./form.fixture";
import { messageOf, withPartner } from "./partners";

const EXPERIMENT = experiment("quality-diversity");
const FORM = formOf(EXPERIMENT.schema);
const preset = (name: string) => EXPERIMENT.presets.find((one) => one.name === name)!.spec as Json;
const part = (path: string, name: string) =>
  (FORM.fields.find((field) => field.path === path) as Union).parts.get(name)!.initial!;

const changed = (original: Json, path: string, value: Json, before = original) =>
  withPartner(FORM, original, before, withValue(before, path, value));

describe("a body that grows and its encoding", () => {
  it("are selected together, with a note", () => {
    const chain = preset("standard");
    const encoded = changed(chain, "control", part("control", "body-graph"));
    expect(valueAt(encoded.document, "body")).toEqual(part("body", "grown"));
    expect(messageOf(encoded.note, encoded.document, "body")).toContain("builder is now grown");
    expect(messageOf(encoded.note, encoded.document, "control")).toBeNull();
    const built = changed(chain, "body", part("body", "grown"));
    expect(valueAt(built.document, "control.encoding")).toBe("body-graph");
    expect(messageOf(built.note, built.document, "control")).toContain("you selected grown");
  });

  it("are left together; a part comes back from the original", () => {
    const chain = preset("standard");
    const grown = changed(chain, "body", part("body", "grown")).document;
    const back = changed(chain, "body", valueAt(chain, "body"), grown);
    expect(back.document).toEqual(chain);
    const zoo = preset("zoo-demo");
    const star = changed(zoo, "body", part("body", "star"));
    expect(valueAt(star.document, "control")).toEqual(part("control", "cppn"));
  });

  it("do not follow other changes", () => {
    const zoo = preset("zoo-demo");
    const longer = changed(zoo, "body.nodes", 64);
    expect([longer.note, valueAt(longer.document, "control")]).toEqual([null, valueAt(zoo, "control")]);
    const ring = changed(preset("standard"), "body", part("body", "ring"));
    expect(ring.note).toBeNull();
  });

  it("lose their note when another part is selected", () => {
    const { note, document } = changed(preset("standard"), "control", part("control", "body-graph"));
    expect(messageOf(note, withValue(document, "body", part("body", "ring")), "body")).toBeNull();
  });
});
