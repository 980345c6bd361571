import { describe, expect, it, vi } from "vitest";

const SWEEPS = Array.from({ length: 7 }, (_, number) => ({ id: String(number) }));
const readSweeps = vi.hoisted(() => vi.fn());
vi.mock("../api/client", () => ({ readSweeps }));

const { readSweepsUpTo } = await import("./sweeps");

describe("a list of sweeps whose specs are long", () => {
  it.each([
    [1, 1],
    [5, 5],
    [7, 7],
    [100, 7],
  ])("with a limit of %i has %i of them", async (limit, expected) => {
    readSweeps.mockImplementation((wanted: number, cursor = "0") => {
      const end = Math.min(Number(cursor) + Math.min(wanted, 2), SWEEPS.length);
      return { items: SWEEPS.slice(Number(cursor), end), next: end < SWEEPS.length ? String(end) : null };
    });
    const { items, next } = await readSweepsUpTo(limit);
    expect(items).toEqual(SWEEPS.slice(0, expected));
    expect(next).toBe(expected < SWEEPS.length ? String(expected) : null);
  });
});
