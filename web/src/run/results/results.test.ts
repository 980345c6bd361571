import { describe, expect, it } from "vitest";
import type { ResultRow } from "../../api/types";
import { columnsOf, sortRows } from "./ResultsTable";

const row = (values: Partial<ResultRow>): ResultRow => ({ creature: null, ...values });

describe("a table", () => {
  const rows = [
    row({ swimmer: "ray", displacement: 2 }),
    row({ swimmer: "worm", displacement: null }),
    row({ swimmer: "cilia", displacement: 10 }),
  ];
  const order = (by: string | null, down: boolean) =>
    sortRows(rows, { by, down }).map(({ swimmer }) => swimmer);

  it("is sorted by a column, with missing values last in both directions", () => {
    expect(order("displacement", false)).toEqual(["ray", "cilia", "worm"]);
    expect(order("displacement", true)).toEqual(["cilia", "ray", "worm"]);
    expect(order("swimmer", false)).toEqual(["cilia", "ray", "worm"]);
    expect(order(null, false)).toEqual(["ray", "worm", "cilia"]);
  });

  it("has every column of any row with its unit, also unknown columns", () => {
    const columns = columnsOf([...rows, row({ limited: 0.5, novelty: true })]);
    const headings = columns.map(({ title, unit, numeric }) => [title, unit, numeric]);
    expect(headings).toEqual([
      ["Swimmer", "", false],
      ["Displacement", "cells/cycle", true],
      ["Limited", "of node steps", true],
      ["Novelty", "", false],
    ]);
    expect(columns[2]!.write(0.5)).toBe("50 %");
    expect(columns[3]!.write(true)).toBe("yes");
  });
});
