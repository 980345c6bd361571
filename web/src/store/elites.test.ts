import { describe, expect, it } from "vitest";
import { elitesByGeneration } from "./elites";

describe("the history of an archive", () => {
  const columns = { cell: [1, 2, 1], fitness: [1, 2, 3], descriptors: [[0], [0], [0]] };
  const history = {
    ...columns,
    generation: 4,
    elite_generation: [1, 1, 4],
    creature: ["a", "b", "c"],
    trusted: [null, false, true],
    measures: {},
    emptied: [] as number[],
    emptied_generation: [] as number[],
  };

  it.each([
    [0, []],
    [1, ["a", "b"]],
    [3, ["a", "b"]],
    [4, ["c", "b"]],
  ])("after generation %s has the last elite of each cell", (generation, creatures) => {
    const then = elitesByGeneration(history)(generation);
    expect([...then.values()].map(({ creature }) => creature)).toEqual(creatures);
  });

  it("has the verdicts of that time's elites", () => {
    const then = elitesByGeneration(history)(4);
    expect([...then.values()].map(({ trusted }) => trusted)).toEqual([true, false]);
  });

  it("is the same in any order of generations", () => {
    const elitesAt = elitesByGeneration(history);
    const names = [4, 1, 0, 3, 4].map((generation) =>
      [...elitesAt(generation).values()].map(({ creature }) => creature).join(""),
    );
    expect(names).toEqual(["cb", "ab", "", "ab", "cb"]);
  });

  it("is without the cells that lost their elite, until they have a new one", () => {
    const losses = { emptied: [1, 2], emptied_generation: [2, 3] };
    const elitesAt = elitesByGeneration({ ...history, ...losses });
    const names = [1, 2, 3, 4, 2, 4].map((generation) =>
      [...elitesAt(generation).values()].map(({ creature }) => creature).join(""),
    );
    expect(names).toEqual(["ab", "b", "", "c", "b", "c"]);
  });
});
