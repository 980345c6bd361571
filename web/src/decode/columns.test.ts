import { describe, expect, it } from "vitest";
import { decodeColumns } from "./columns";

const COLUMNS = [
  { name: "cell", type: "int32", shape: [3] },
  { name: "descriptors", type: "float64", shape: [3, 2] },
  { name: "creature", type: "uint8", shape: [3, 2] },
  { name: "trusted", type: "int8", shape: [3] },
  { name: "measures.speed", type: "float64", shape: [3] },
];

/** Each array at a multiple of eight bytes. */
function bytesOf(header: object, ...arrays: ArrayBufferView[]): ArrayBuffer {
  const text = JSON.stringify(header);
  const padded = text.padEnd(text.length + ((12 - (text.length % 8)) % 8));
  const parts = [new TextEncoder().encode(padded), ...arrays.map(({ buffer }) => new Uint8Array(buffer))];
  const bytes = [...new Uint8Array(Uint32Array.of(padded.length).buffer)];
  for (const part of parts) {
    bytes.push(...part);
    while (bytes.length % 8) bytes.push(0);
  }
  return Uint8Array.from(bytes).buffer;
}

describe("columns as bytes", () => {
  it("become the document that JSON has", () => {
    const bytes = bytesOf(
      { format: "microcosmos-columns/1", generation: 7, axes: [], columns: COLUMNS },
      Int32Array.of(1, 2, 300),
      Float64Array.of(0.5, 1, 2, 3, 4, 5),
      Uint8Array.of(0, 255, 16, 1, 171, 205),
      Int8Array.of(-1, 0, 1),
      Float64Array.of(1.5, NaN, -2),
    );
    expect(decodeColumns(bytes)).toEqual({
      generation: 7,
      axes: [],
      cell: [1, 2, 300],
      descriptors: [
        [0.5, 1],
        [2, 3],
        [4, 5],
      ],
      creature: ["00ff", "1001", "abcd"],
      trusted: [null, false, true],
      measures: { speed: [1.5, null, -2] },
    });
  });

  it("may be empty", () => {
    const columns = COLUMNS.map((one) => ({ ...one, shape: [0, ...one.shape.slice(1)] }));
    const found = decodeColumns<Record<string, unknown>>(
      bytesOf({ format: "microcosmos-columns/1", columns }),
    );
    expect(found).toEqual({
      cell: [],
      descriptors: [],
      creature: [],
      trusted: [],
      measures: { speed: [] },
    });
  });

  it("of another format are refused", () => {
    expect(() => decodeColumns(bytesOf({ format: "microcosmos-columns/2", columns: [] }))).toThrow(
      "format must be microcosmos-columns/1",
    );
  });
});
