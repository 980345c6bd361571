import { expect, it } from "vitest";
import { elite } from "./archive.fixture";
import { trustOf, withVerdict } from "./archiveView";

const elites = new Map([true, false, null].map((trusted, cell) => [cell, { ...elite(1), trusted }]));

it.each([
  ["", [0, 1, 2]],
  ["trusted", [0]],
  ["distrusted", [1]],
  ["unaudited", [2]],
  ["constructor", [0, 1, 2]],
])("the verdict %o in an address shows the elites %o", (given, shown) => {
  const choice = trustOf(new URLSearchParams({ trust: given }));
  expect([...withVerdict(elites, choice).keys()]).toEqual(shown);
});
