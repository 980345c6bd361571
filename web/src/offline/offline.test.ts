/** A creature as one HTML file. */

import { afterEach, describe, expect, it, vi } from "vitest";
import * as api from "../api/client";
import { type Replay, decodeReplay } from "../decode/replay";
import { replayBytes } from "../decode/replay.fixture";
import { packMotion, unpackMotion } from "./motion";
import { type About, filled, forScript, pageOf } from "./page";
import { packed, unpacked } from "./packing";

vi.mock("../api/client", () => ({
  readReplay: vi.fn(() => Promise.resolve(null)),
  readEvaluation: vi.fn(() => Promise.resolve(null)),
}));
afterEach(() => void vi.unstubAllGlobals());

const through = (replay: Replay) => unpackMotion(packMotion(replay).buffer);

/** A wave over a large world, which passes once in all frames. */
function wave(frames: number, [width, height]: [number, number]): Replay {
  const small = decodeReplay(replayBytes());
  const vorticity = new Int8Array(frames * width * height);
  for (let at = 0; at < vorticity.length; at++) {
    const [frame, x] = [Math.floor(at / (width * height)), Math.floor(at / height) % width];
    vorticity[at] = Math.round(120 * Math.sin(2 * Math.PI * (x / width - frame / (frames - 1))));
  }
  const positions = Float32Array.from({ length: 6 * frames }, (_, i) => 1000 + 0.37 * i);
  return { ...small, header: { ...small.header, frames, size: [width, height] }, positions, vorticity };
}

describe("packed motion", () => {
  it("keeps a small replay", () => {
    const replay = decodeReplay(replayBytes());
    const found = through(replay);
    expect(found.vorticity).toEqual(replay.vorticity);
    expect(found.header).toMatchObject({ frames: 2, every: 5, edges: replay.header.edges, size: [2, 1] });
    found.positions.forEach((x, i) => expect(x).toBeCloseTo(replay.positions[i]!, 3));
  });

  it("of a large world is small, and near the recorded flow and poses", () => {
    const replay = wave(101, [200, 100]);
    expect(packMotion(replay).length).toBeLessThan(replay.vorticity.length / 4);
    const found = through(replay);
    const errors = found.vorticity.map((level, i) => Math.abs(level - replay.vorticity[i]!));
    expect(Math.max(...errors.slice(0, 20_000), ...errors.slice(-20_000))).toBeLessThan(6);
    expect(Math.abs(found.positions.at(-1)! - replay.positions.at(-1)!)).toBeLessThan(0.01);
  });
});

describe("the page", () => {
  it("carries bytes", async () => {
    const bytes = Uint8Array.from({ length: 70_000 }, (_, i) => (i * i) % 251);
    expect(new Uint8Array(await unpacked(await packed(bytes)))).toEqual(bytes);
  });

  it("holds texts that cannot end their element", () => {
    const hostile = "</script><b>$&</b>";
    const html = filled("<title><!--title--></title><body><!--data--></body>", hostile, {
      about: forScript({ title: hostile }),
    });
    expect(html).toContain("<title>&lt;/script>&lt;b>$&amp;&lt;/b></title>");
    expect(html.match(/<\/script>/g)).toHaveLength(1);
    const [, json] = /id="about">(.*)<\/script>/.exec(html)!;
    expect(JSON.parse(json!)).toEqual({ title: hostile });
  });

  it("needs a template with both places", () => {
    expect(() => filled("<!--title-->", "Eel", {})).toThrow("one place for data");
  });
});

describe("a page that is left while its replay is rendered", () => {
  it("asks no more", async () => {
    vi.useFakeTimers();
    vi.stubGlobal("fetch", () => Promise.resolve(new Response("")));
    const leaving = new AbortController();
    const about = { title: "Eel", address: null, creature: { sha256: "ab" } } as About;
    const page = expect(pageOf(about, leaving.signal)).rejects.toThrow("aborted");
    await vi.advanceTimersByTimeAsync(2500);
    const asked = vi.mocked(api.readReplay).mock.calls.length;
    expect(asked).toBe(3);
    leaving.abort();
    await page;
    await vi.advanceTimersByTimeAsync(5000);
    expect(vi.mocked(api.readReplay).mock.calls.length).toBe(asked);
    expect(vi.mocked(api.readEvaluation).mock.calls.length).toBe(asked);
    vi.useRealTimers();
  });
});
