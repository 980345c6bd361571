import { describe, expect, it } from "vitest";
import { changeKept, keep, readKept } from "./kept";

describe("a kept value", () => {
  const stored = new Map<string, string>();
  const storage = () =>
    ({
      getItem: (key: string) => stored.get(key) ?? null,
      setItem: (key: string, value: string) => void stored.set(key, value),
    }) as unknown as Storage;
  const forbidden = () => {
    throw new DOMException("forbidden", "SecurityError");
  };

  it("is read again", () => {
    keep("views", ["one"], storage);
    expect(readKept<string[]>("views", [], storage)).toEqual(["one"]);
  });

  it.each([null, "", "{", "null"])("that is %s is the given one", (text) => {
    if (text !== null) stored.set("odd", text);
    expect(readKept("odd", 7, storage)).toBe(7);
  });

  it("changes as it is now, since another tab may have changed it", () => {
    const add = (name: string) => (now: string[]) => [...now, name];
    keep("names", ["one"], storage);
    expect(changeKept("names", ["of this tab"], add("two"), storage)).toEqual(["one", "two"]);
    expect(readKept("names", [], storage)).toEqual(["one", "two"]);
    expect(changeKept("names", ["of this tab"], add("two"), forbidden)).toEqual(["of this tab", "two"]);
  });

  it("is the given one where storage is forbidden", () => {
    keep("views", 1, forbidden);
    expect(readKept("views", 2, forbidden)).toBe(2);
  });
});
