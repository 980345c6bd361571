/** Shared creatures of other installations. */

import { describe, expect, it } from "vitest";
import { nameOf } from "../decode/identity";
import { foreignFileOf, limited, verified } from "./foreign";
import { foreignFileUrl, foreignNamesUrl, importPage } from "./address";
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

  it("that is no creature is refused", () => {
    const ancestors = [[{}], 3, null, {}].map((each) => ({ ...creature(1), ancestors: each }));
    for (const body of [null, [], {}, { identity: null }, ...ancestors]) {
      expect(() => verified(body as never)).toThrow("no creature");
    }
  });

  it("of any size is read up to the limit alone", async () => {
    let [sent, cancelled] = [0, false];
    const endless = new ReadableStream<Uint8Array>({
      pull: (controller) => {
        sent += 100;
        controller.enqueue(new Uint8Array(100));
      },
      cancel: () => void (cancelled = true),
    });
    await expect(limited(new Response(endless), 1000)).rejects.toThrow("at most 1000 bytes");
    expect(sent).toBeLessThan(2000);
    expect(cancelled).toBe(true);
    expect((await limited(new Response(null, { status: 204 }))).size).toBe(0);
    const whole = await limited(new Response("ab".repeat(500)), 1000);
    expect(await whole.text()).toBe("ab".repeat(500));
  });
});
