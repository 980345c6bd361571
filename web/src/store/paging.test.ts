import { describe, expect, it } from "vitest";
import { pagesOf } from "./paging";

interface Asked {
  cursor: string | undefined;
  answer: (items: number[], next: string | null) => void;
  refuse: (reason: Error) => void;
}

function list() {
  const asked: Asked[] = [];
  const shown: [items: number[], cursor?: string][] = [];
  const failed: unknown[] = [];
  const read = (cursor?: string) =>
    new Promise<{ items: number[]; next: string | null }>((resolve, refuse) => {
      asked.push({ cursor, answer: (items, next) => resolve({ items, next }), refuse });
    });
  const load = pagesOf(
    read,
    ({ items }, cursor) => shown.push([items, cursor]),
    (reason) => failed.push(reason),
  );
  return { asked, shown, failed, load };
}

describe("a list of pages", () => {
  it("has each page once, also when the next one is asked for twice", async () => {
    const { asked, shown, load } = list();
    const first = load();
    asked[0]!.answer([0, 1], "b");
    await first;
    const next = [load("b"), load("b")];
    asked[1]!.answer([2, 3], null);
    await Promise.all(next);
    expect(asked.map(({ cursor }) => cursor)).toEqual([undefined, "b"]);
    expect(shown).toEqual([[[0, 1], undefined], [[2, 3], "b"]]); // prettier-ignore
  });

  it("that begins anew takes no page of the old one", async () => {
    const { asked, shown, failed, load } = list();
    const first = load();
    asked[0]!.answer([0, 1], "b");
    await first;
    const late = load("b");
    const anew = load();
    asked[2]!.answer([7], null);
    await anew;
    asked[1]!.answer([2, 3], null);
    await late;
    expect(shown.at(-1)).toEqual([[7], undefined]);
    expect(failed).toEqual([]);
  });

  it("can be asked again after a failure", async () => {
    const { asked, shown, failed, load } = list();
    const first = load();
    asked[0]!.answer([0], "b");
    await first;
    const next = load("b");
    asked[1]!.refuse(new Error("Busy."));
    await next;
    const again = load("b");
    asked[2]!.answer([1], null);
    await again;
    expect([failed.length, shown.at(-1)]).toEqual([1, [[1], "b"]]);
  });
});
