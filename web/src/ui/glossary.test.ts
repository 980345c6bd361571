import { expect, test } from "vitest";
import { define, parse } from "./glossary";

test("terms have plain definitions", () => {
  const markdown = "# G\n\nIntro.\n\n## QD score\n\nA `sum` of\n[elites](a.md).\n\n## Run\n\nOne.\n";
  expect([...parse(markdown)]).toEqual([
    ["qd score", "A sum of elites."],
    ["run", "One."],
  ]);
});

test("the glossary of the documentation is part of the page", () => {
  expect(define("QD score")).toMatch(/^The sum of the fitness/);
  expect(define("Niche")).toBeUndefined();
});
