import { describe, expect, it } from "vitest";
import type { Run } from "../api/types";
import { type Action, INITIAL_STATE, type State, epochOf, reduce } from "./reducer";
import { RUN, generation, elites, after, opened, creatures } from "./state.fixture";

describe("events", () => {
  it("change the cells that they name and no others", () => {
    const next = reduce(opened, elites(3, 5, "cc"));
    expect(creatures(next)).toEqual([
      [0, "aa"],
      [5, "cc"],
    ]);
    expect(creatures(opened)).toEqual([
      [0, "aa"],
      [5, "bb"],
    ]);
  });

  it("make a run's numbers and curves longer, each generation once", () => {
    const event = { type: "generation", event: generation(3) } as const;
    const next = reduce(reduce(opened, event), event);
    expect(next.details.get("a")!.curves!.generation).toEqual([1, 2, 3]);
    expect(next.runs.get("a")).toMatchObject({ generation: 3, progress: 0.3, qd_score: 3 });
  });

  it("add what else they tell to the curves, whenever it is told first", () => {
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

  it("of how a run stands leave out what it is, which was told before", () => {
    const { spec: _, ...standing } = { ...RUN, generation: 3 };
    const next = reduce(opened, { type: "run", run: standing });
    expect(next.runs.get("a")).toEqual({ ...RUN, generation: 3 });
    expect(after({ type: "run", run: standing }).runs.size).toBe(0);
  });

  it("of runs that are not open leave no trace", () => {
    expect(after(elites(1, 0, "x")).details.size).toBe(0);
  });

  it("put no run into a list, but say that the list may be another", () => {
    const page = { items: [RUN], next: null };
    const listed = after({ type: "list", asked: "{}", page, known: 0, sent: 0 });
    const newer = reduce(listed, { type: "run", run: { ...RUN, id: "b" } });
    expect([newer.listed, newer.listVersion]).toEqual([["a"], listed.listVersion + 1]);
  });

  it("make news of a run's state, name, tags and note, not of its figures", () => {
    const run = { ...RUN, status: "running", name: null, tags: ["one"], note: null } as Run;
    const before = after({ type: "run", run });
    const raised = (change: Partial<Run>) =>
      reduce(before, { type: "run", run: { ...run, ...change } }).listVersion - before.listVersion;
    expect(raised({ tags: ["one"], generation: 5, evaluations: 99 })).toBe(0);
    for (const change of [{ status: "finished" as const }, { name: "x" }, { tags: [] }, { note: "y" }]) {
      expect(raised(change)).toBe(1);
    }
  });

  it("leave out the rest of a list that nobody asks for any more", () => {
    const more = reduce(first, { type: "more", asked: "{}", page: page("b"), cursor: null, sent: 0 });
    expect(more.listed).toEqual(["a", "b"]);
    const stale = { type: "more", asked: "other", page: page("b"), cursor: null, sent: 0 } as const;
    expect(reduce(first, stale).listed).toEqual(["a"]);
  });

  it("of a list keep what was loaded while the list was asked for again", () => {
    const more = reduce(first, { type: "more", asked: "{}", page: page("b"), cursor: null, sent: 0 });
    const again = reduce(more, { type: "list", asked: "{}", page: page("a"), known: 1, sent: 0 });
    expect([again.listed, again.listVersion]).toEqual([["a", "b"], more.listVersion + 1]);
  });

  it("ask for a list again that was replaced while more of it was loaded", () => {
    const next = { ...page("b"), next: "other place" };
    const moved = reduce(first, { type: "list", asked: "{}", page: next, known: 1, sent: 0 });
    const more = reduce(moved, { type: "more", asked: "{}", page: page("c"), cursor: null, sent: 0 });
    expect([more.listed, more.listVersion]).toEqual([["b", "c"], moved.listVersion + 1]);
  });
});

const page = (id: string) => ({ items: [{ ...RUN, id }], next: null });

const first = after({ type: "list", asked: "{}", page: page("a"), known: 0, sent: 0 });

describe("an answer", () => {
  const { spec: _, ...standing } = { ...RUN, status: "finished", generation: 10 } as Run;
  const event: Action = { type: "run", run: standing };
  const late = { ...RUN, status: "running", generation: 5, name: "old" } as Run;
  const known = after({ type: "response", run: late, sent: 0 });
  const answers: [string, (sent: number) => Action][] = [
    ["to a question for a run", (sent) => ({ type: "response", run: late, sent })],
    [
      "to a question for a list",
      (sent) => ({ type: "list", asked: "", page: { items: [late], next: null }, known: 0, sent }),
    ],
    [
      "to a question for more",
      (sent) => ({ type: "more", asked: "", page: { items: [late], next: null }, cursor: null, sent }),
    ],
  ];

  it.each(answers)("%s does not undo what an event told meanwhile", (_, answer) => {
    const state = reduce(reduce(known, event), answer(known.eventCount));
    expect(state.runs.get("a")).toMatchObject({ status: "finished", generation: 10 });
  });

  it.each(answers)("%s takes what an event told before anything else was known", (_, answer) => {
    const state = reduce(reduce(INITIAL_STATE, event), answer(0));
    expect(state.runs.get("a")).toMatchObject({ status: "finished", spec: RUN.spec });
    expect(state.eventsWithoutSpec.size).toBe(0);
  });

  it.each(answers)("%s counts where it was asked after the last event", (_, answer) => {
    const told = reduce(known, event);
    expect(reduce(told, answer(told.eventCount)).runs.get("a")!.status).toBe("running");
  });

  it("is overtaken by generations, rewinds, resets and newer answers too", () => {
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

  it("leaves the spec the object it was", () => {
    const again = reduce(known, { type: "response", run: structuredClone(late), sent: known.eventCount });
    expect(again.runs.get("a")!.spec).toBe(RUN.spec);
  });
});

describe("what is said here of a run", () => {
  const known = after({ type: "run", run: { ...RUN, name: "old" } });
  const said = reduce(known, { type: "edit", run: "a", change: { name: "new" } });

  it("is shown at once, and makes news only when the server has heard it", () => {
    expect([said.runs.get("a")!.name, said.listVersion]).toEqual(["new", known.listVersion]);
    const done = reduce(said, { type: "change", run: { ...RUN, name: "new" }, sent: said.eventCount });
    expect([done.runs.get("a")!.name, done.listVersion]).toEqual(["new", known.listVersion + 1]);
  });

  it("outlives lists that were asked for before it, and before the server had heard it", () => {
    const list = (sent: number): Action => {
      return {
        type: "list",
        asked: "",
        page: { items: [{ ...RUN, name: "old" }], next: null },
        known: 0,
        sent,
      };
    };
    expect(reduce(said, list(known.eventCount)).runs.get("a")!.name).toBe("new");
    const done = reduce(said, { type: "change", run: { ...RUN, name: "new" }, sent: said.eventCount });
    expect(reduce(done, list(said.eventCount)).runs.get("a")!.name).toBe("new");
  });
});

describe("a run that is put into the bin elsewhere", () => {
  it("may not belong to a list any more, or to another", () => {
    const known = reduce(INITIAL_STATE, { type: "run", run: RUN });
    const binned = reduce(known, { type: "run", run: { ...RUN, deleted_at: "2026-01-03T00:00:00Z" } });
    expect(binned.listVersion).toBe(known.listVersion + 1);
    expect(reduce(binned, { type: "run", run: RUN }).listVersion).toBe(known.listVersion + 2);
  });
});

describe("a run that is gone for good", () => {
  const page = { items: [RUN, { ...RUN, id: "b" }], next: null };
  const listed = reduce(INITIAL_STATE, { type: "list", asked: "", page, known: 0, sent: 0 });
  const gone = reduce(listed, { type: "purge", run: "a" });

  it("leaves the lists at once, which are read anew", () => {
    expect(gone.listed).toEqual(["b"]);
    expect(gone.runs.has("a")).toBe(false);
    expect(gone.listVersion).toBeGreaterThan(listed.listVersion);
  });

  it("is asked for anew by whoever looks at it, and so told to be gone", () => {
    expect(epochOf(gone, "a")).toBeGreaterThan(epochOf(listed, "a"));
  });

  it("is no news of a sweep but its own", () => {
    expect(gone.sweepVersions.size).toBe(0);
    const swept = reduce(listed, { type: "run", run: { ...RUN, sweep: "s" } });
    expect(reduce(swept, { type: "purge", run: "a" }).sweepVersions.get("s")).toBe(2);
  });
});
