import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import { Problem } from "../api/problem";
import { POLL_MS, poll } from "./polling";

type Answer = string | Error | null;

function heard(answers: Answer[]) {
  const said: [string, string | null][] = [];
  const ask = vi.fn(async () => {
    const answer = answers.shift() ?? null;
    if (answer instanceof Error) throw answer;
    return answer;
  });
  const stop = poll<string>(ask, {
    value: (value) => said.push(["value", value]),
    note: (note) => said.push(["note", note]),
    error: (error) => said.push(["error", error]),
  });
  return { said, ask, stop };
}

beforeEach(() => void vi.useFakeTimers());
afterEach(() => void vi.useRealTimers());

describe("polling", () => {
  it("goes on after the server was away or busy, and says so meanwhile", async () => {
    const busy = new Problem(503, { detail: "Busy." });
    const { said, ask } = heard([null, new TypeError("failed"), busy, "done"]);
    await vi.advanceTimersByTimeAsync(10 * POLL_MS);
    expect(said).toEqual([
      ["note", null],
      ["note", "The server cannot be reached. Check that it is running and try again."],
      ["note", "Busy."],
      ["note", null],
      ["value", "done"],
    ]);
    expect(ask).toHaveBeenCalledTimes(4);
  });

  it("ends with an answer that it failed", async () => {
    const { said, ask } = heard([new Problem(404, { detail: "No such creature." }), "late"]);
    await vi.advanceTimersByTimeAsync(10 * POLL_MS);
    expect(said).toEqual([["error", "No such creature."]]);
    expect(ask).toHaveBeenCalledTimes(1);
  });

  it("ends when it is stopped", async () => {
    const { said, ask, stop } = heard([null, null, "done"]);
    await vi.advanceTimersByTimeAsync(POLL_MS);
    stop();
    await vi.advanceTimersByTimeAsync(10 * POLL_MS);
    expect(ask).toHaveBeenCalledTimes(2);
    expect(said.map(([kind]) => kind)).not.toContain("value");
  });
});
