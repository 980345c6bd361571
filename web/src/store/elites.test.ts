import { describe, expect, it } from "vitest";
import { walkThrough } from "./elites";

describe("the history of an archive", () => {
  const columns = { cell: [1, 2, 1], fitness: [1, 2, 3], descriptors: [[0], [0], [0]] };
  const history = {
    ...columns,
    generation: 4,
    elite_generation: [1, 1, 4],
    creature: ["a", "b", "c"],
    measures: {},
  };

  it.each([
    [0, []],
    [1, ["a", "b"]],
    [3, ["a", "b"]],
    [4, ["c", "b"]],
  ])("after generation %s has the last elite of each cell", (generation, creatures) => {
    const then = walkThrough(history)(generation);
    expect([...then.values()].map(({ creature }) => creature)).toEqual(creatures);
  });

  it("is the same in any order of generations", () => {
    const walk = walkThrough(history);
    const seen = [4, 1, 0, 3, 4].map((generation) =>
      [...walk(generation).values()].map(({ creature }) => creature).join(""),
    );
    expect(seen).toEqual(["cb", "ab", "", "ab", "cb"]);
  });
});
