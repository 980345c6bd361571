import { describe, expect, it } from "vitest";
import { parseJson } from "./json";

describe("JSON that people wrote", () => {
  it.each([
    '{"a": 1, "b": {"a": 2}, "c": [{"a": 3}, {"a": 4}]}',
    '{"a": "a", "b": "{\\"a\\": 1", "c": ","}',
    "7",
  ])("is read: %s", (text) => expect(parseJson(text)).toEqual(JSON.parse(text)));

  it.each([
    ['{"a": 1, "b": 2, "a": 3}', "a"],
    ['{"b": [{"c\\"": 1}, {"c\\"": 1, "c\\"" : 2}]}', 'c"'],
    ['{"\\u0061": 1, "a"\n:2}', "a"],
    [`{"a": 1, "a"${" ".repeat(200)}: 2}`, "a"],
  ])("is refused where a name is given twice: %s", (text, name) => {
    expect(() => parseJson(text)).toThrow(`“${name}” is given twice`);
  });

  it("is refused where it is none", () => {
    expect(() => parseJson('{"a": }')).toThrow(SyntaxError);
  });
});
