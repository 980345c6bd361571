import { describe, expect, it } from "vitest";
import { type Swimmer, joined, together } from "./swimmer";

/** A filament of some nodes. */
function filament(nodes: number, numbers: Record<string, number> = {}): Swimmer {
  const [edges, joints] = [nodes - 1, nodes - 2];
  const row = (count: number, of: (i: number) => number) => Array.from({ length: count }, (_, i) => of(i));
  const pair = (count: number) => Int32Array.from(row(count, (i) => i).flatMap((i) => [i, i + 1]));
  const floats = (count: number) => Float32Array.from(row(count, (i) => i + nodes / 10));
  const counts = { nodes, edges, joints, bodies: 1, matched: 1, laid_out: 1, soft: 0 };
  return {
    numbers: { ...counts, ...numbers },
    arrays: new Map<string, Float32Array | Int32Array>([
      ["positions", floats(2 * nodes)],
      ["angles", floats(edges)],
      ["boxes", Float32Array.of(nodes, -nodes)],
      ["edges", pair(edges)],
      ["joints", pair(joints)],
      ["member", new Int32Array(nodes)],
      ["piece", new Int32Array(nodes)],
      ["present", new Int32Array(nodes).fill(1)],
      ["layout angles", floats(edges)],
      ["layout rest angles", floats(joints)],
      ["colours of edges", new Int32Array(0)],
      ["colours of joints", new Int32Array(0)],
      ["whole turns", new Float32Array(0)],
      ["stretch", floats(edges)],
      ["shear", floats(edges)],
      ["bend", floats(joints)],
      ["bends", new Int32Array(joints).fill(1)],
      ["collected", new Float32Array(0)],
      ["parameters", Float32Array.of(nodes)],
    ]),
    planes: [],
    rest: { "rest angles": floats(joints), "rest lengths": floats(edges) },
    window: { start: 0, stop: 1 },
    stroke: 1,
    step: 0,
  };
}

describe("creatures in one water", () => {
  const { numbers, arrays } = joined([filament(4), filament(3)]);

  it("are counted together, in the water of the first", () => {
    expect(numbers).toMatchObject({ nodes: 7, edges: 5, joints: 3, bodies: 2 });
    expect(arrays.get("parameters")).toEqual(Float32Array.of(4));
  });

  it("have nodes, edges and bodies of their own", () => {
    expect([...arrays.get("edges")!]).toEqual([0, 1, 1, 2, 2, 3, 4, 5, 5, 6]);
    expect([...arrays.get("joints")!]).toEqual([0, 1, 1, 2, 3, 4]);
    expect([...arrays.get("member")!]).toEqual([0, 0, 0, 0, 1, 1, 1]);
    expect([...arrays.get("piece")!]).toEqual([0, 0, 0, 0, 4, 4, 4]);
    expect(arrays.get("positions")!.length).toBe(14);
    expect([...arrays.get("boxes")!]).toEqual([4, -4, 3, -3]);
  });

  it("of a school stay together in another box", () => {
    const school = filament(4, { bodies: 2, height: 64, width: 48 });
    school.arrays.set("positions", Float32Array.of(1, 2, 3, 4, 5, 6, 7, 8));
    school.arrays.set("member", Int32Array.of(0, 0, 1, 1));
    school.arrays.set("boxes", Float32Array.of(5, 5, 6, 4));
    expect([...together(school)]).toEqual([1, 2, 3, 4, 69, -42, 71, -40]);
  });

  it("may have no joint", () => {
    const [bare, other] = [filament(2), filament(4)];
    for (const swimmers of [
      [bare, other],
      [other, bare],
    ]) {
      const found = joined(swimmers);
      expect(found.numbers).toMatchObject({ nodes: 6, edges: 4, joints: 2 });
      expect(found.arrays.get("bends")!.length).toBe(2);
    }
  });

  it("take their rest shapes in one way", () => {
    expect(() => joined([filament(4), filament(4, { matched: 0 })])).toThrow("in another way");
  });
});
