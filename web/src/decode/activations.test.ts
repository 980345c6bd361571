import { describe, expect, it } from "vitest";
import type { Genes, Spec } from "../api/types";
import { networkOf } from "./network";
import { ROWS, activationsOf, inputsOf, phaseOf } from "./activations";
import cases from "./networks.fixture.json";

describe("the values of a network", () => {
  cases.forEach(({ genome, steps, expected }, number) => {
    it(`equal those of the engine, network ${number + 1}`, () => {
      const network = networkOf(genome as unknown as Genes);
      const { values } = activationsOf(network, genome.control as unknown as Spec, steps);
      const outputs = network.neurons.filter(({ role }) => role === "output");
      outputs.forEach(({ id }, output) => {
        [0, 5, 31, 95].forEach((column, i) => {
          [0, 17, 30, 47].forEach((row, k) => {
            const value = expected[output]![i]![k]!;
            const found = values.get(id)![column * ROWS + row]!;
            expect(Math.abs(found - value)).toBeLessThan(2e-4 * Math.max(1, Math.abs(value)));
          });
        });
      });
    });
  });

  it("depend on the sensed energy", () => {
    const { genome, steps } = cases[0]!;
    const sensing = { ...genome.control, wave_number: null, sense_energy: true } as unknown as Spec;
    const genes = {
      encoding: "cppn",
      control: sensing,
      inputs: ["position", "sine", "cosine", "energy"],
      outputs: ["rest_angle"],
      nodes: { id: [0, 1, 2, 3, 4], activation: Array(5).fill("identity"), bias: base64([0, 0, 0, 0, 0]) },
      connections: { innovation: [0], source: [3], target: [4], enabled: [true], weight: base64([2]) },
    } as Genes;
    const { values } = activationsOf(networkOf(genes), sensing, steps, 0.75);
    expect(new Set(values.get(4))).toEqual(new Set([1.5]));
  });

  it("have a cursor in phase, also if a recurrent network starts within a period", () => {
    const recurrent = inputsOf({ period: 30, recurrent: true });
    const at = (step: number, from: number) => phaseOf(step, { from, to: from + 30 }, recurrent);
    expect(at(75, 70)).toBeCloseTo(5 / 30);
    expect(at(69, 70)).toBeCloseTo(29 / 30);
    expect(at(10, 70)).toBe(0);
    expect(at(75, 0)).toBeCloseTo(0.5);
    const linear = inputsOf({ timer: "linear", period: 30 });
    expect(phaseOf(75, { from: 0, to: 100 }, linear)).toBe(0.75);
  });
});

const base64 = (values: number[]) =>
  btoa(String.fromCharCode(...new Uint8Array(Float32Array.from(values).buffer)));
