import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import { Problem } from "../api/problem";
import { POLL_MS, poll } from "./polling";

type Answer = string | Error | null;

function polled(answers: Answer[]) {
  const calls: [string, string | null][] = [];
  const ask = vi.fn(async () => {
    const answer = answers.shift() ?? null;
    if (answer instanceof Error) throw answer;
    return answer;
  });
  const stop = poll<string>(ask, {
    value: (value) => calls.push(["value", value]),
    note: (note) => calls.push(["note", note]),
    error: (error) => calls.push(["error", error]),
  });
  return { calls, ask, stop };
}

beforeEach(() => void vi.useFakeTimers());
afterEach(() => void vi.useRealTimers());

describe("polling", () => {
  it("continues while the server is away or busy, and notes it", async () => {
    const busy = new Problem(503, { detail: "Busy." });
    const { calls, ask } = polled([null, new TypeError("failed"), busy, "done"]);
    await vi.advanceTimersByTimeAsync(10 * POLL_MS);
    expect(calls).toEqual([
      ["note", null],
      ["note", "The server cannot be reached. Check that it is running and try again."],
      ["note", "Busy."],
      ["note", null],
      ["value", "done"],
    ]);
    expect(ask).toHaveBeenCalledTimes(4);
  });

  it("ends with a permanent failure", async () => {
    const { calls, ask } = polled([new Problem(404, { detail: "No such creature." }), "late"]);
    await vi.advanceTimersByTimeAsync(10 * POLL_MS);
    expect(calls).toEqual([["error", "No such creature."]]);
    expect(ask).toHaveBeenCalledTimes(1);
  });

  it("ends when it is stopped", async () => {
    const { calls, ask, stop } = polled([null, null, "done"]);
    await vi.advanceTimersByTimeAsync(POLL_MS);
    stop();
    await vi.advanceTimersByTimeAsync(10 * POLL_MS);
    expect(ask).toHaveBeenCalledTimes(2);
    expect(calls.map(([kind]) => kind)).not.toContain("value");
  });
});
