import { beforeEach, describe, expect, it, vi } from "vitest";
import type { LogEntry } from "../api/types";

let stored: LogEntry[] = [];
const requested = vi.fn();

vi.mock("../api/client", () => ({
  readLog: async (_: string, limit: number, after?: number) => {
    requested(after);
    const later = stored.filter(({ id }) => after === undefined || id > after);
    return { entries: after === undefined ? later.slice(-limit) : later.slice(0, limit) };
  },
}));

const { extendLog } = await import("./log");

const entries = (from: number, to: number, attempt: number) =>
  Array.from({ length: to - from }, (_, i) => ({ id: from + i, attempt }) as LogEntry);

describe("a log that is read again", () => {
  beforeEach(() => requested.mockClear());

  it("starts after finished attempts, and drops entries that the server dropped", async () => {
    stored = [...entries(1, 401, 1), ...entries(401, 404, 2)];
    const known = await extendLog("a", [], false);
    expect(known).toEqual(stored);
    stored = [...entries(1, 401, 1), ...entries(401, 402, 2), ...entries(404, 405, 2)];
    expect(await extendLog("a", known, false)).toEqual(stored);
    expect(requested.mock.calls).toEqual([[undefined], [400]]);
  });

  it("reads all pages of new entries", async () => {
    stored = [...entries(1, 11, 0), ...entries(11, 12, 1)];
    const known = await extendLog("a", [], false);
    stored = [...entries(1, 11, 0), ...entries(11, 1400, 1)];
    expect(await extendLog("a", known, false)).toEqual(stored);
  });

  it("has the last page at first, and all entries on request", async () => {
    stored = entries(1, 1201, 3);
    expect(await extendLog("a", [], false)).toEqual(stored.slice(-500));
    expect(await extendLog("a", [], true)).toEqual(stored);
  });
});
