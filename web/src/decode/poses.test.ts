import { describe, expect, it } from "vitest";
import { decodePoseBatch, decodePoses } from "./poses";
import { cells, header, path, poseBytes } from "./poses.fixture";

describe("a pose stream", () => {
  it("holds positions in cells, and the path", () => {
    const stream = decodePoses(poseBytes());
    expect([...stream.positions]).toEqual(cells);
    expect([...stream.path]).toEqual(path);
    expect(stream.header).toEqual(header);
  });

  it("that is too short is refused with both sizes", () => {
    const whole = poseBytes();
    const short = whole.slice(0, whole.byteLength - 1);
    const needed = `needs ${whole.byteLength} bytes, got ${short.byteLength}`;
    expect(() => decodePoses(short)).toThrow(needed);
  });

  it("of another format is refused", () => {
    expect(() => decodePoses(poseBytes({ ...header, format: "other/9" }))).toThrow("got other/9");
  });
});

describe("a batch", () => {
  const framed = (bytes: ArrayBuffer) => [
    ...new Uint8Array(Uint32Array.of(bytes.byteLength).buffer),
    ...new Uint8Array(bytes),
  ];

  it("holds streams one after another, each after its length", () => {
    const other = poseBytes({ ...header, creature: "cd" });
    const batch = Uint8Array.from([...framed(poseBytes()), ...framed(other)]).buffer;
    const streams = decodePoseBatch(batch);
    expect(streams.map((stream) => stream.header.creature)).toEqual(["ab", "cd"]);
    expect([...streams[1]!.positions]).toEqual(cells);
  });

  it("may be empty", () => {
    expect(decodePoseBatch(new ArrayBuffer(0))).toEqual([]);
  });
});
