import { beforeEach, describe, expect, it, vi } from "vitest";
import { Problem } from "../api/problem";
import type { Run, RunChange } from "../api/types";

/** The run on the server, and the changes that wait for its answer. */
let stored: Run;
let waiting: { accept: () => void; refuse: () => void }[] = [];
const answer = (how: "accept" | "refuse") => waiting.splice(0).forEach((change) => change[how]());

vi.mock("../api/client", () => ({
  readRun: async () => stored,
  changeRun: (_: string, change: RunChange) =>
    new Promise<Run>((resolve, reject) => {
      const accept = () => resolve((stored = { ...stored, ...change }));
      waiting.push({ accept, refuse: () => reject(new Problem(409, { detail: "Refused." })) });
    }),
}));

const { addTag, editRun, removeNote, removeTag } = await import("./commands");
const { currentState, update } = await import("./store");
const { INITIAL_STATE, withRunEvent } = await import("./state");
const { RUN } = await import("./state.fixture");

const shown = () => currentState().runs.get("a")!;
const toasts = () => currentState().toasts;
const settled = () => new Promise((resolve) => setTimeout(resolve));

/** Another client changes the run, and an event tells of it. */
function changeElsewhere(change: Partial<Run>) {
  stored = { ...stored, ...change };
  update((state) => withRunEvent(state, stored));
}

beforeEach(() => {
  stored = { ...RUN, name: "mine", tags: ["one", "two", "three"], note: "old", priority: "normal" } as Run;
  waiting = [];
  update(() => withRunEvent(INITIAL_STATE, stored));
});

describe("an edit", () => {
  it("is shown at once; refused, it is taken back alone", async () => {
    const edit = editRun("a", { priority: "high" });
    expect(shown().priority).toBe("high");
    changeElsewhere({ name: "theirs" });
    answer("refuse");
    expect(await edit).toBe(false);
    expect(shown()).toMatchObject({ priority: "normal", name: "theirs" });
    expect(toasts().map(({ text }) => text)).toEqual(["Refused."]);
  });

  it("that follows another is taken back to what the server has", async () => {
    const first = removeTag(shown(), "one");
    const second = removeTag(shown(), "two");
    expect(shown().tags).toEqual(["three"]);
    answer("refuse");
    await Promise.all([first, second]);
    expect(shown().tags).toEqual(["one", "two", "three"]);
    expect(toasts().every(({ action }) => !action)).toBe(true);
  });

  it("can be undone once the server has accepted it", async () => {
    const removed = removeTag(shown(), "two");
    expect(toasts()).toEqual([]);
    answer("accept");
    await removed;
    toasts()[0]!.action!.run();
    answer("accept");
    await settled();
    expect(stored.tags).toEqual(["one", "three", "two"]);
  });
});

describe("a removed note", () => {
  it("comes back with Undo, unless another was written since", async () => {
    for (const [since, kept] of [
      [null, "old"],
      ["new", "new"],
    ]) {
      changeElsewhere({ note: "old" });
      const removed = removeNote(shown());
      answer("accept");
      await removed;
      changeElsewhere({ note: since });
      toasts().at(-1)!.action!.run();
      answer("accept");
      await settled();
      expect(stored.note).toBe(kept);
    }
  });
});

it("a tag that a run has is not added again", () => {
  addTag(shown(), "one");
  expect(waiting).toEqual([]);
});
