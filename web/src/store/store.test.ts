import { describe, expect, it } from "vitest";
import type { Run } from "../api/types";
import { type Action, INITIAL_STATE, type State, epochOf, reduce } from "./reducer";
import { RUN, generation, elites, after, opened, creatures } from "./state.fixture";

describe("events", () => {
  it("change the cells that they name", () => {
    const next = reduce(opened, elites(3, 5, "cc"));
    expect(creatures(next)).toEqual({ 0: "aa", 5: "cc" });
    expect(creatures(opened)).toEqual({ 0: "aa", 5: "bb" });
  });

  it("extend curves and update figures, each generation once", () => {
    const event = { type: "generation", event: generation(3) } as const;
    const next = reduce(reduce(opened, event), event);
    expect(next.details.get("a")!.curves!.generation).toEqual([1, 2, 3]);
    expect(next.runs.get("a")).toMatchObject({ generation: 3, progress: 0.3, qd_score: 3 });
  });

  it("add other numbers to the curves, whichever generation has them first", () => {
    const next = [3, 4].reduce<State>(
      (state, number) => reduce(state, { type: "generation", event: generation(number) }),
      opened,
    );
    expect(next.details.get("a")!.curves!.summary).toEqual({
      inserted: [5, 6, 3, 4],
      corrected: [null, 0.5, null, null],
      late: [null, null, 3, null],
    });
    const back = reduce(next, { type: "rewind", event: { run: "a", generation: 2 } });
    expect(back.details.get("a")!.curves!.summary.inserted).toEqual([5, 6]);
  });

  it("of a run leave its spec as it is", () => {
    const { spec: _, ...withoutSpec } = { ...RUN, generation: 3 };
    const next = reduce(opened, { type: "run", run: withoutSpec });
    expect(next.runs.get("a")).toEqual({ ...RUN, generation: 3 });
    expect(after({ type: "run", run: withoutSpec }).runs.size).toBe(0);
  });

  it("of runs that are not shown are not kept", () => {
    expect(after(elites(1, 0, "x")).details.size).toBe(0);
  });

  it("add no run to a list, but raise its version", () => {
    const page = { items: [RUN], next: null };
    const listed = after({ type: "list", query: "{}", page, known: 0, sent: 0 });
    const newer = reduce(listed, { type: "run", run: { ...RUN, id: "b" } });
    expect([newer.listed, newer.listVersion]).toEqual([["a"], listed.listVersion + 1]);
  });

  it("raise the version of the list for status, name, tags and note, not for figures", () => {
    const run = { ...RUN, status: "running", name: null, tags: ["one"], note: null } as Run;
    const before = after({ type: "run", run });
    const raised = (change: Partial<Run>) =>
      reduce(before, { type: "run", run: { ...run, ...change } }).listVersion - before.listVersion;
    expect(raised({ tags: ["one"], generation: 5, evaluations: 99 })).toBe(0);
    for (const change of [{ status: "finished" as const }, { name: "x" }, { tags: [] }, { note: "y" }]) {
      expect(raised(change)).toBe(1);
    }
  });

  it("ignore more of a list that is no longer shown", () => {
    const more = reduce(first, { type: "more", query: "{}", page: page("b"), cursor: null, sent: 0 });
    expect(more.listed).toEqual(["a", "b"]);
    const stale = { type: "more", query: "other", page: page("b"), cursor: null, sent: 0 } as const;
    expect(reduce(first, stale).listed).toEqual(["a"]);
  });

  it("keep pages that were loaded while the list was read again", () => {
    const more = reduce(first, { type: "more", query: "{}", page: page("b"), cursor: null, sent: 0 });
    const again = reduce(more, { type: "list", query: "{}", page: page("a"), known: 1, sent: 0 });
    expect([again.listed, again.listVersion]).toEqual([["a", "b"], more.listVersion + 1]);
  });

  it("read a list again that was replaced while more of it was loaded", () => {
    const next = { ...page("b"), next: "other place" };
    const moved = reduce(first, { type: "list", query: "{}", page: next, known: 1, sent: 0 });
    const more = reduce(moved, { type: "more", query: "{}", page: page("c"), cursor: null, sent: 0 });
    expect([more.listed, more.listVersion]).toEqual([["b", "c"], moved.listVersion + 1]);
  });
});

const page = (id: string) => ({ items: [{ ...RUN, id }], next: null });

const first = after({ type: "list", query: "{}", page: page("a"), known: 0, sent: 0 });

describe("an answer", () => {
  const { spec: _, ...withoutSpec } = { ...RUN, status: "finished", generation: 10 } as Run;
  const event: Action = { type: "run", run: withoutSpec };
  const late = { ...RUN, status: "running", generation: 5, name: "old" } as Run;
  const known = after({ type: "response", run: late, sent: 0 });
  const answers: [string, (sent: number) => Action][] = [
    ["to a read of a run", (sent) => ({ type: "response", run: late, sent })],
    [
      "to a read of a list",
      (sent) => ({ type: "list", query: "", page: { items: [late], next: null }, known: 0, sent }),
    ],
    [
      "to a read of more",
      (sent) => ({ type: "more", query: "", page: { items: [late], next: null }, cursor: null, sent }),
    ],
  ];

  it.each(answers)("%s does not overwrite a later event", (_, answer) => {
    const state = reduce(reduce(known, event), answer(known.eventCount));
    expect(state.runs.get("a")).toMatchObject({ status: "finished", generation: 10 });
  });

  it.each(answers)("%s takes the state of an earlier event", (_, answer) => {
    const state = reduce(reduce(INITIAL_STATE, event), answer(0));
    expect(state.runs.get("a")).toMatchObject({ status: "finished", spec: RUN.spec });
    expect(state.eventsWithoutSpec.size).toBe(0);
  });

  it.each(answers)("%s wins if requested after the last event", (_, answer) => {
    const told = reduce(known, event);
    expect(reduce(told, answer(told.eventCount)).runs.get("a")!.status).toBe("running");
  });

  it("loses against generations, rewinds, resets and newer answers", () => {
    const run = { ...late, generation: 5 };
    const rewind = { type: "rewind", event: { run: "a", generation: 1 } } as const;
    for (const action of [
      { type: "generation", event: generation(7) },
      rewind,
      { type: "reset" },
    ] as Action[]) {
      const state = reduce(known, action);
      expect(reduce(state, { type: "response", run, sent: known.eventCount }).runs).toEqual(state.runs);
    }
    const other = reduce(known, { type: "run", run: { ...RUN, id: "b" } });
    const newer = reduce(other, { type: "response", run: { ...run, name: "new" }, sent: other.eventCount });
    expect(reduce(newer, { type: "response", run, sent: 0 }).runs.get("a")!.name).toBe("new");
  });

  it("keeps the spec object", () => {
    const again = reduce(known, { type: "response", run: structuredClone(late), sent: known.eventCount });
    expect(again.runs.get("a")!.spec).toBe(RUN.spec);
  });
});

describe("an edit of a run", () => {
  const known = after({ type: "run", run: { ...RUN, name: "old" } });
  const edited = reduce(known, { type: "edit", run: "a", change: { name: "new" } });

  it("is shown at once, and raises the version of the list when the server confirms it", () => {
    expect([edited.runs.get("a")!.name, edited.listVersion]).toEqual(["new", known.listVersion]);
    const done = reduce(edited, { type: "change", run: { ...RUN, name: "new" }, sent: edited.eventCount });
    expect([done.runs.get("a")!.name, done.listVersion]).toEqual(["new", known.listVersion + 1]);
  });

  it("outlives lists that were read before the server confirmed it", () => {
    const list = (sent: number): Action => {
      return {
        type: "list",
        query: "",
        page: { items: [{ ...RUN, name: "old" }], next: null },
        known: 0,
        sent,
      };
    };
    expect(reduce(edited, list(known.eventCount)).runs.get("a")!.name).toBe("new");
    const done = reduce(edited, { type: "change", run: { ...RUN, name: "new" }, sent: edited.eventCount });
    expect(reduce(done, list(edited.eventCount)).runs.get("a")!.name).toBe("new");
  });
});

describe("a run that somebody moves to the bin", () => {
  it("raises the version of the list", () => {
    const known = reduce(INITIAL_STATE, { type: "run", run: RUN });
    const binned = reduce(known, { type: "run", run: { ...RUN, deleted_at: "2026-01-03T00:00:00Z" } });
    expect(binned.listVersion).toBe(known.listVersion + 1);
    expect(reduce(binned, { type: "run", run: RUN }).listVersion).toBe(known.listVersion + 2);
  });
});

describe("a purged run", () => {
  const page = { items: [RUN, { ...RUN, id: "b" }], next: null };
  const listed = reduce(INITIAL_STATE, { type: "list", query: "", page, known: 0, sent: 0 });
  const gone = reduce(listed, { type: "purge", run: "a" });

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
    const swept = reduce(listed, { type: "run", run: { ...RUN, sweep: "s" } });
    expect(reduce(swept, { type: "purge", run: "a" }).sweepVersions.get("s")).toBe(2);
  });
});
