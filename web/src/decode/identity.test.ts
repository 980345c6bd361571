/** Names of creatures. */

import { describe, expect, it } from "vitest";
import zoo from "../../../docs/pictures/zoo-0.json";
import { canonical } from "./canonical";
import { nameOf, sha256 } from "./identity";

describe("the hash", () => {
  it.each([0, 1, 55, 56, 63, 64, 65, 1000])("of %i bytes is SHA-256", async (length) => {
    const bytes = Uint8Array.from({ length }, (_, i) => (i * 37) % 256);
    const digest = new Uint8Array(await crypto.subtle.digest("SHA-256", bytes));
    expect(sha256(bytes)).toBe([...digest].map((byte) => byte.toString(16).padStart(2, "0")).join(""));
  });

  it("names a creature as the engine does", () => {
    expect(nameOf(zoo.identity)).toBe(zoo.sha256);
  });
});

describe("canonical JSON", () => {
  it("orders names by UTF-16, and writes numbers as RFC 8785 does", () => {
    const value = { "\u20ac": 1, "\r": [1e21, 0.000001, 1e-7, -0, 1.0], a: { b: null, a: "é\n" } };
    expect(canonical(value)).toBe('{"\\r":[1e+21,0.000001,1e-7,0,1],"a":{"a":"é\\n","b":null},"\u20ac":1}');
  });
});
