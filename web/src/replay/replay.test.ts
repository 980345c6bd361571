import { describe, expect, it } from "vitest";
import { type Replay, decodeReplay } from "../decode/replay";
import { replayBytes } from "../decode/replay.fixture";
import { Playhead, handlesKey } from "./clock";
import { coloursOf, fieldOf, fieldsOf } from "./fields";
import { replayViewOf, queryOf } from "./ReplayPlayer";
import { Tracers, velocityAt } from "./tracers";

const replay = decodeReplay(replayBytes());

describe("the fields of a replay", () => {
  it("show the speed from both components of the velocity", () => {
    const field = fieldOf("speed", [replay], "light")!;
    const value = field.plane(replay, 0)[0]! * field.quantum(replay);
    expect(value).toBeCloseTo(0.01 * Math.hypot(10, 30), 2);
    expect(field.range[0]).toBe(0);
    expect(coloursOf(field, replay)).toHaveLength(256);
  });

  it("are those that the replay contains", () => {
    expect(fieldsOf([replay])).toEqual(["vorticity", "speed", "energy", "none"]);
    const energy = { scale: 2, frames: 0 };
    expect(fieldsOf([{ ...replay, header: { ...replay.header, energy } }])).not.toContain("energy");
    const still = { ...replay, vorticity: new Int8Array(4) };
    expect(fieldsOf([still])).toEqual(["energy", "none"]);
  });
});

/** A flow that is a wave along x: u = 0, v = sin(x). */
function waving(frames: number, size: [number, number], speed: number): Replay {
  const [width, height] = size;
  const cells = width * height;
  const velocity = new Int8Array(2 * frames * cells);
  for (let frame = 0; frame < frames; frame++) {
    for (let x = 0; x < width; x++) {
      const level = Math.round(127 * Math.sin((2 * Math.PI * x) / width));
      velocity.fill(level, (2 * frame + 1) * cells + x * height, (2 * frame + 1) * cells + (x + 1) * height);
    }
  }
  const header = { ...replay.header, frames, size, every: 10, velocity: { scale: speed } };
  return { ...replay, header, velocity };
}

describe("tracers", () => {
  const flow = waving(5, [32, 16], 0.1);

  it("interpolate the velocity between cells, across the borders of the world", () => {
    const [u, v] = velocityAt(flow, 1.5, 8, 3.25);
    expect(u).toBe(0);
    expect(v).toBeCloseTo(0.1, 6);
    expect(velocityAt(flow, 0, 32 + 8, -16)[1]).toBeCloseTo(0.1, 6);
    expect(velocityAt(flow, 0, 31.5, 0)[1]).toBeCloseTo(-0.05 * Math.sin(Math.PI / 16), 3);
  });

  it("follow the flow, whichever frames were shown before", () => {
    const [there, back] = [new Tracers(flow), new Tracers(flow)];
    const [start, end] = [there.at(0), there.at(4)];
    for (let i = 0; i < start.length; i += 2) {
      expect(end[i]).toBeCloseTo(start[i]!, 5);
      const [, v] = velocityAt(flow, 0, start[i]!, 0);
      expect(end[i + 1]! - start[i + 1]!).toBeCloseTo(40 * v, 4);
    }
    for (const frame of [1, 2, 3, 4]) back.at(frame);
    expect(back.at(4)).toEqual(end);
  });
});

describe("the playhead of a replay", () => {
  it("steps to the next whole frame and stops there", () => {
    const playhead = new Playhead(true);
    playhead.move(2.4);
    playhead.step(1, 10);
    expect([playhead.time, playhead.playing]).toEqual([3, false]);
    playhead.step(-1, 10);
    expect(playhead.time).toBe(2);
    playhead.scrub(9.5);
    playhead.step(1, 10);
    playhead.step(1, 10);
    expect(playhead.time).toBe(10);
  });

  it("has its view in the address", () => {
    const change = { field: "speed", tracers: true, follow: false, speed: 4 } as const;
    const words = Object.entries(queryOf(change)).filter(([, word]) => word !== null);
    expect(replayViewOf(new URLSearchParams(words as [string, string][]))).toEqual(change);
    expect(replayViewOf(new URLSearchParams("field=heat&speed=3")).speed).toBe(1);
    expect(replayViewOf(new URLSearchParams("field=heat")).field).toBeNull();
  });
});

describe("the keys of a replay", () => {
  // An element is given by its ancestors and by the selectors that it matches.
  const element = (selectors: string[], within: object[] = []) => {
    const self = { closest: (asked: string) => (selectors.some((one) => asked.includes(one)) ? self : null) };
    return Object.assign(self, { within }) as unknown as Element;
  };
  const player = {
    contains: (inside: unknown) => (inside as { within: object[] }).within.includes(player),
  } as unknown as Element;

  it("work within the player; the space bar works everywhere", () => {
    const [inside, outside] = [element([], [player]), element([])];
    for (const key of [",", ".", "Home", "End", "ArrowLeft", "ArrowRight"]) {
      expect([handlesKey(key, inside, player), handlesKey(key, outside, player)]).toEqual([true, false]);
    }
    expect(handlesKey(" ", outside, player)).toBe(true);
    expect(handlesKey("Home", inside, null)).toBe(false);
  });

  it("are left to elements that use them", () => {
    const button = element(["button"], [player]);
    expect([handlesKey(" ", button, player), handlesKey("Home", button, player)]).toEqual([false, true]);
    const choice = element(["select"], [player]);
    expect([handlesKey(" ", choice, player), handlesKey("End", choice, player)]).toEqual([false, false]);
  });
});
