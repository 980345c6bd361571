import { describe, expect, it } from "vitest";
import type { Run } from "../api/types";
import { applyChange, applyEdit, applyResponses } from "./reconcile";
import {
  INITIAL_STATE,
  type State,
  epochOf,
  reset,
  withList,
  withMore,
  withoutRun,
  withRunEvent,
  withSweepEvent,
} from "./state";
import { RUN, after, creatures, elites, generation, opened, rewind, run } from "./state.fixture";

describe("events", () => {
  it("change the cells that they name", () => {
    const next = after(opened, elites(3, 5, "cc"));
    expect(creatures(next)).toEqual({ 0: "aa", 5: "cc" });
    expect(creatures(opened)).toEqual({ 0: "aa", 5: "bb" });
  });

  it("keep the verdicts of other elites, and have none of new ones", () => {
    const elitesThen = after(opened, elites(3, 5, "cc")).details.get("a")!.elites;
    expect([...elitesThen].map(([cell, { trusted }]) => [cell, trusted])).toEqual([
      [0, false],
      [5, null],
    ]);
  });

  it("extend curves and update figures, each generation once", () => {
    const next = after(opened, generation(3), generation(3));
    expect(next.details.get("a")!.curves!.generation).toEqual([1, 2, 3]);
    expect(next.runs.get("a")).toMatchObject({ generation: 3, progress: 0.3, qd_score: 3 });
  });

  it("add other numbers to the curves, whichever generation has them first", () => {
    const next = after(opened, generation(3), generation(4));
    expect(next.details.get("a")!.curves!.summary).toEqual({
      inserted: [5, 6, 3, 4],
      corrected: [null, 0.5, null, null],
      late: [null, null, 3, null],
    });
    expect(after(next, rewind(2)).details.get("a")!.curves!.summary.inserted).toEqual([5, 6]);
  });

  it("of a run leave its spec as it is", () => {
    const { spec: _, ...withoutSpec } = { ...RUN, generation: 3 };
    const next = withRunEvent(opened, withoutSpec);
    expect(next.runs.get("a")).toEqual({ ...RUN, generation: 3 });
    expect(withRunEvent(INITIAL_STATE, withoutSpec).runs.size).toBe(0);
  });

  it("of an unknown run without its spec let lists ask for it once, and when it moves", () => {
    const { spec: _, ...withoutSpec } = RUN;
    const first = withRunEvent(INITIAL_STATE, withoutSpec);
    expect(first.listVersion).toBe(INITIAL_STATE.listVersion + 1);
    const next = withRunEvent(first, { ...withoutSpec, generation: 3 });
    expect(next.listVersion).toBe(first.listVersion);
    const ended = withRunEvent(next, { ...withoutSpec, status: "cancelled" });
    expect(ended.listVersion).toBe(next.listVersion + 1);
  });

  it("of an extended run without its spec let it be fetched again", () => {
    const { spec: _, ...withoutSpec } = RUN;
    const same = withRunEvent(opened, { ...withoutSpec, generation: 3 });
    expect(epochOf(same, "a")).toBe(epochOf(opened, "a"));
    const extended = withRunEvent(opened, { ...withoutSpec, generations: 20 });
    expect(epochOf(extended, "a")).toBe(epochOf(opened, "a") + 1);
    const whole = withRunEvent(opened, { ...RUN, generations: 20 });
    expect(epochOf(whole, "a")).toBe(epochOf(opened, "a"));
  });

  it("of runs that are not shown are not kept", () => {
    expect(after(INITIAL_STATE, elites(1, 0, "x")).details.size).toBe(0);
  });

  it("add no run to a list, but raise its version", () => {
    const newer = withRunEvent(first, { ...RUN, id: "b" });
    expect([newer.listed, newer.listVersion]).toEqual([["a"], first.listVersion + 1]);
  });

  it("raise the version of the list for status, name, tags and note, not for figures", () => {
    const known = { ...RUN, status: "running", name: null, tags: ["one"], note: null } as Run;
    const before = withRunEvent(INITIAL_STATE, known);
    const raised = (change: Partial<Run>) =>
      withRunEvent(before, { ...known, ...change }).listVersion - before.listVersion;
    expect(raised({ tags: ["one"], generation: 5, evaluations: 99 })).toBe(0);
    for (const change of [{ status: "finished" as const }, { name: "x" }, { tags: [] }, { note: "y" }]) {
      expect(raised(change)).toBe(1);
    }
  });

  it("ignore more of a list that is no longer shown", () => {
    expect(more(first, "b").listed).toEqual(["a", "b"]);
    expect(more(first, "b", "other").listed).toEqual(["a"]);
  });

  it("keep pages that were loaded while the list was read again", () => {
    const extended = more(first, "b");
    const again = withList(extended, { query: "{}", page: page("a"), known: 1, sentAt: 0 });
    expect([again.listed, again.listVersion]).toEqual([["a", "b"], extended.listVersion + 1]);
  });

  it("read a list again that was replaced while more of it was loaded", () => {
    const next = { ...page("b"), next: "other place" };
    const replaced = withList(first, { query: "{}", page: next, known: 1, sentAt: 0 });
    const extended = more(replaced, "c");
    expect([extended.listed, extended.listVersion]).toEqual([["b", "c"], replaced.listVersion + 1]);
  });
});

const page = (id: string) => ({ items: [{ ...RUN, id }], next: null });

const first = withList(INITIAL_STATE, { query: "{}", page: page("a"), known: 0, sentAt: 0 });

const more = (state: State, id: string, query = "{}") =>
  withMore(state, { query, page: page(id), cursor: null, sentAt: 0 });

describe("an answer", () => {
  const { spec: _, ...withoutSpec } = { ...RUN, status: "finished", generation: 10 } as Run;
  const event = run(withoutSpec);
  const late = { ...RUN, status: "running", generation: 5, name: "old" } as Run;
  const known = applyResponses(INITIAL_STATE, [late], 0);
  const list = { query: "", page: { items: [late], next: null } };
  const answers: [string, (state: State, sentAt: number) => State][] = [
    ["to a read of a run", (state, sentAt) => applyResponses(state, [late], sentAt)],
    ["to a read of a list", (state, sentAt) => withList(state, { ...list, known: 0, sentAt })],
    ["to a read of more", (state, sentAt) => withMore(state, { ...list, cursor: null, sentAt })],
  ];

  it.each(answers)("%s does not overwrite a later event", (_, answer) => {
    const state = answer(event(known), known.eventCount);
    expect(state.runs.get("a")).toMatchObject({ status: "finished", generation: 10 });
  });

  it.each(answers)("%s takes the state of an earlier event", (_, answer) => {
    const state = answer(event(INITIAL_STATE), 0);
    expect(state.runs.get("a")).toMatchObject({ status: "finished", spec: RUN.spec });
    expect(state.eventsWithoutSpec.size).toBe(0);
  });

  it.each(answers)("%s wins if requested after the last event", (_, answer) => {
    const later = event(known);
    expect(answer(later, later.eventCount).runs.get("a")!.status).toBe("running");
  });

  it("loses against generations, rewinds, resets and newer answers", () => {
    for (const change of [generation(7), rewind(1), reset]) {
      const state = change(known);
      expect(applyResponses(state, [late], known.eventCount).runs).toEqual(state.runs);
    }
    const other = withRunEvent(known, { ...RUN, id: "b" });
    const newer = applyResponses(other, [{ ...late, name: "new" }], other.eventCount);
    expect(applyResponses(newer, [late], 0).runs.get("a")!.name).toBe("new");
  });

  it("keeps the spec object", () => {
    const again = applyResponses(known, [structuredClone(late)], known.eventCount);
    expect(again.runs.get("a")!.spec).toBe(RUN.spec);
  });

  it("takes the spec of an extended run, from an answer and from an event", () => {
    const spec = { ...RUN.spec, seed: 99 } as Run["spec"];
    const answered = applyResponses(known, [{ ...late, spec }], known.eventCount);
    expect(answered.runs.get("a")!.spec).toEqual(spec);
    expect(withRunEvent(known, { ...RUN, spec }).runs.get("a")!.spec).toEqual(spec);
  });
});

describe("an edit of a run", () => {
  const known = withRunEvent(INITIAL_STATE, { ...RUN, name: "old" });
  const edited = applyEdit(known, "a", { name: "new" });
  const done = applyChange(edited, { ...RUN, name: "new" }, edited.eventCount);

  it("is shown at once, and raises the version of the list when the server confirms it", () => {
    expect([edited.runs.get("a")!.name, edited.listVersion]).toEqual(["new", known.listVersion]);
    expect([done.runs.get("a")!.name, done.listVersion]).toEqual(["new", known.listVersion + 1]);
  });

  it("outlives lists that were read before the server confirmed it", () => {
    const list = { query: "", page: { items: [{ ...RUN, name: "old" }], next: null }, known: 0 };
    expect(withList(edited, { ...list, sentAt: known.eventCount }).runs.get("a")!.name).toBe("new");
    expect(withList(done, { ...list, sentAt: edited.eventCount }).runs.get("a")!.name).toBe("new");
  });
});

describe("a run that is moved to the bin", () => {
  it("raises the version of the list", () => {
    const known = withRunEvent(INITIAL_STATE, RUN);
    const binned = withRunEvent(known, { ...RUN, deleted_at: "2026-01-03T00:00:00Z" });
    expect(binned.listVersion).toBe(known.listVersion + 1);
    expect(withRunEvent(binned, RUN).listVersion).toBe(known.listVersion + 2);
  });
});

describe("a purged run", () => {
  const page = { items: [RUN, { ...RUN, id: "b" }], next: null };
  const listed = withList(INITIAL_STATE, { query: "", page, known: 0, sentAt: 0 });
  const gone = withoutRun(listed, { run: "a" });

  it("leaves the list at once, which is read again", () => {
    expect(gone.listed).toEqual(["b"]);
    expect(gone.runs.has("a")).toBe(false);
    expect(gone.listVersion).toBeGreaterThan(listed.listVersion);
  });

  it("is read again by its page", () => {
    expect(epochOf(gone, "a")).toBeGreaterThan(epochOf(listed, "a"));
  });

  it("raises the version of its own sweep only", () => {
    expect(gone.sweepVersions.size).toBe(0);
    const swept = withRunEvent(listed, { ...RUN, sweep: "s" });
    expect(withoutRun(swept, { run: "a" }).sweepVersions.get("s")).toBe(2);
  });
});

describe("events of a sweep", () => {
  it("raise its version, and that of lists if it was created or steered", () => {
    const known = { ...RUN, sweep: "s", status: "running" } as Run;
    const once = withRunEvent(INITIAL_STATE, known);
    expect(once.sweepVersions.get("s")).toBe(1);
    const again = withRunEvent(once, { ...known, generation: 3 });
    expect([again.sweepVersions.get("s"), again.listVersion]).toEqual([2, once.listVersion]);
    const steered = withSweepEvent(again, { sweep: "s" });
    expect([steered.sweepVersions.get("s"), steered.listVersion]).toEqual([3, again.listVersion + 1]);
  });
});
