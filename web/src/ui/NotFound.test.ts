import { describe, expect, it } from "vitest";
import { reasonOf } from "./NotFound";

describe("the page of a missing resource", () => {
  it.each(["0190a6a0-0000-7000-8000-000000000001", "ab".repeat(32)])("repeats the server about %s", (id) => {
    expect(reasonOf("No such run.", id)).toBe("No such run.");
  });

  it("names a malformed id and hides the parser's message", () => {
    const reason = reasonOf("Input should be a valid UUID, invalid length", "abc");
    expect(reason).toContain("abc");
    expect(reason).not.toContain("UUID");
  });
});
