import { beforeEach, expect, it, vi } from "vitest";

const asked: string[] = [];
vi.mock("../api/client", () => ({
  readPoses: (sha: string) => {
    asked.push(sha);
    return Promise.reject(new Error("None."));
  },
}));
const { request } = await import("./poses");

const visible = (...names: string[]) => names.map((creature) => ({ creature }));
const many = (letter: string) => visible(...Array.from({ length: 20 }, (_, i) => `${letter}${i}`));
const settled = () => vi.waitFor(() => new Promise((resolve) => setTimeout(resolve)));
const names = (found: { creature: string }[]) => found.map(({ creature }) => creature);

beforeEach(() => void asked.splice(0));

async function allOf(count: number) {
  await vi.waitFor(() => expect(asked.length).toBeGreaterThanOrEqual(count));
  await settled();
}

it("lists on one page do not take each other's creatures away", async () => {
  const [gallery, choices] = [Symbol(), Symbol()];
  request(gallery, null, many("a"), true);
  request(choices, null, many("b"), true);
  await allOf(40);
  expect(asked.toSorted()).toEqual(names([...many("a"), ...many("b")]).toSorted());
});

it("a list that has changed asks for no more of what it showed before", async () => {
  const gallery = Symbol();
  request(gallery, null, many("c"), true);
  request(gallery, null, visible("d0"), true);
  await allOf(9);
  expect(asked).toEqual([...names(many("c")).slice(0, 8), "d0"]);
});

it("a creature that another list does not render is rendered for the one that does", async () => {
  const lacking = () => Promise.reject(new Error("None."));
  request(Symbol(), lacking, visible("e0"), false);
  request(Symbol(), lacking, visible("e0"), true);
  await allOf(1);
  expect(asked).toEqual(["e0"]);
});

it("a batch that failed is asked for again", async () => {
  const batches: string[][] = [];
  const failing = (some: readonly { creature: string }[]) => {
    batches.push(names([...some]));
    return Promise.reject(new Error("Refused."));
  };
  for (let times = 0; times < 2; times++) {
    request(Symbol(), failing, visible("f0"), false);
    await settled();
  }
  expect(batches).toEqual([["f0"], ["f0"]]);
});
