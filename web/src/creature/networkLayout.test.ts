import { expect, test } from "vitest";
import type { Neuron } from "../decode/network";
import { layoutOf } from "./networkLayout";

test("nodes of a column are apart, close to connected nodes, inputs and outputs in their order", () => {
  const role = (id: number): Neuron["role"] => (id < 3 ? "input" : id < 5 ? "output" : "hidden");
  const neurons = Array.from({ length: 8 }, (_, id): Neuron => {
    const depth = { input: 0, hidden: 1, output: 2 }[role(id)];
    return { id, role: role(id), label: "", activation: "tanh", bias: 0, depth };
  });
  const pairs = ["2 5", "5 4", "0 6", "6 3", "1 7", "7 7"].map((pair) => pair.split(" ").map(Number));
  const links = pairs.map(([source, target]) => ({
    source: source!,
    target: target!,
    weight: 1,
    enabled: true,
  }));
  const { height, spots } = layoutOf({ neurons, links, depth: 2 });
  const order = (...ids: number[]) => ids.sort((a, b) => spots.get(a)!.y - spots.get(b)!.y);
  expect(order(2, 1, 0)).toEqual([0, 1, 2]);
  expect(order(4, 3)).toEqual([3, 4]);
  expect(order(5, 6, 7)).toEqual([6, 7, 5]);
  const [high, middle, low] = [6, 7, 5].map((id) => spots.get(id)!.y);
  expect(Math.min(middle! - high!, low! - middle!)).toBeGreaterThanOrEqual(58);
  expect(high).toBeGreaterThan(0);
  expect(low).toBeLessThan(height);
});
