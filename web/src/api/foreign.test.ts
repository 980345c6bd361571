/** Shared creatures of other installations. */

import { describe, expect, it } from "vitest";
import { nameOf } from "../decode/identity";
import { foreignFileOf, verified } from "./foreign";
import { foreignFileUrl, foreignNamesUrl, importPage } from "./shareAddress";
import type { Creature } from "./types";

const SHA = "ab".repeat(32);

describe("the address of a share", () => {
  it.each([
    ["https://lab.example/s/Ab-_9", "https://lab.example/api/v1/shares/Ab-_9/creature.json"],
    [" http://127.0.0.1:8001/x/s/a/ ", "http://127.0.0.1:8001/x/api/v1/shares/a/creature.json"],
    [
      `https://lab.example/s/a/creatures/${SHA}`,
      `https://lab.example/api/v1/shares/a/creature.json?creature=${SHA}`,
    ],
  ])("%s leads to its file", (address, file) => {
    expect(foreignFileUrl(address)).toBe(file);
    expect(new URL(importPage(address)!, "http://x").searchParams.get("share")).toBe(address.trim());
  });

  it.each(["", "An eel", "https://lab.example/shares/a", "javascript://x/s/a", "https://a@lab.example/s/a"])(
    "is not %j",
    (text) => {
      expect([foreignFileUrl(text), importPage(text)]).toEqual([null, null]);
    },
  );
});

describe("all creatures of a share", () => {
  const names = "https://lab.example/a/api/v1/shares/x/creatures.json";

  it("have their names at an address of their own, unless one is named", () => {
    expect(foreignNamesUrl("https://lab.example/a/s/x/")).toBe(names);
    expect(foreignNamesUrl(`https://lab.example/a/s/x/creatures/${SHA}`)).toBeNull();
    expect(foreignNamesUrl("An eel")).toBeNull();
  });

  it("have files without ancestors", () => {
    const file = "https://lab.example/a/api/v1/shares/x/creature.json";
    expect(foreignFileOf(names, SHA)).toBe(`${file}?creature=${SHA}&ancestors=false`);
  });
});

describe("a file", () => {
  const creature = (steps: number) => {
    const identity = { task: { steps } };
    return { identity, sha256: nameOf(identity) } as unknown as Creature;
  };

  it("is verified with its ancestors", () => {
    const found = verified({ ...creature(1), ancestors: [creature(2)] });
    expect([found.creature.sha256, found.ancestors.length]).toEqual([creature(1).sha256, 1]);
    const forged = { ...creature(2), sha256: SHA };
    expect(() => verified({ ...creature(1), ancestors: [forged] })).toThrow(`SHA-256 ${SHA}`);
  });
});
