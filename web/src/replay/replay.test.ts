import { describe, expect, it } from "vitest";
import { type Header, type Replay, decodeReplay } from "../decode/replay";
import { anglesOf, lengthsOf } from "../decode/shape";
import { keyAction } from "./clock";
import { coloursOf, fieldOf, fieldsOf } from "./fields";
import { replayViewOf, queryOf } from "./look";
import { Moment } from "./moment";
import { Tracers, velocityAt } from "./tracers";

const header = {
  format: "microcosmos-replay/2",
  frames: 2,
  nodes: 3,
  every: 5,
  steps: 5,
  edges: [
    [0, 1],
    [1, 2],
  ],
  joints: [[0, 1]],
  size: [2, 1],
  vorticity: { scale: 1 },
  velocity: { scale: 1.27 },
  energy: { scale: 2, frames: 1 },
} as unknown as Header;

// An elbow that is straight at the start and turns by a right angle to the left.
const positions = [0, 0, 1, 0, 2, 0, 0, 0, 1, 0, 1, 1.5];

const [angles, lengths] = [
  [0.25, 0.5],
  [1, 1, 1.25, 1],
];

const planes = [1, 2, 3, 4, 10, 20, 30, 40, 50, 60, 70, 80, 0, 255];

function bytes(head: object, floats: number[], levels: number[]): ArrayBuffer {
  let text = JSON.stringify(head);
  while ((4 + text.length) % 4) text += " ";
  const whole = new Uint8Array(4 + text.length + 4 * floats.length + levels.length);
  new DataView(whole.buffer).setUint32(0, text.length, true);
  whole.set(new TextEncoder().encode(text), 4);
  whole.set(new Uint8Array(Float32Array.from(floats).buffer), 4 + text.length);
  whole.set(levels, 4 + text.length + 4 * floats.length);
  return whole.buffer;
}

const replay = decodeReplay(bytes(header, [...positions, ...angles, ...lengths], planes));

describe("a replay of the second format", () => {
  it("holds rest shapes, velocity and energy", () => {
    expect([...replay.positions]).toEqual(positions);
    expect([...replay.drive!.angles]).toEqual(angles);
    expect([...replay.drive!.lengths]).toEqual(lengths);
    expect([...replay.vorticity]).toEqual([1, 2, 3, 4]);
    expect([...replay.drive!.velocity]).toEqual([10, 20, 30, 40, 50, 60, 70, 80]);
    expect([...replay.drive!.energy]).toEqual([0, 255]);
  });

  it("is refused where a plane is missing", () => {
    const short = bytes(header, [...positions, ...angles, ...lengths], planes.slice(1));
    expect(() => decodeReplay(short)).toThrow("2 frames need");
  });

  it("tells angles and lengths, asked for and done, from the start on", () => {
    const turned = anglesOf(replay);
    expect([...turned.asked.values]).toEqual([0.25, 0.5]);
    expect(turned.done.values[1]).toBeCloseTo(Math.PI / 2, 6);
    const stretched = lengthsOf(replay);
    expect([...stretched.asked.values]).toEqual([0, 0, 0.25, 0]);
    expect([...stretched.done.values]).toEqual([0, 0, 0, 0.5]);
  });

  it("shows the speed of both parts of the velocity", () => {
    const field = fieldOf("speed", [replay], "light")!;
    const value = field.plane(replay, 0)[0]! * field.quantum(replay);
    expect(value).toBeCloseTo(0.01 * Math.hypot(10, 30), 2);
    expect(field.range[0]).toBe(0);
    expect(coloursOf(field, replay)).toHaveLength(256);
  });

  it("offers the fields it has", () => {
    expect(fieldsOf([replay])).toEqual(["vorticity", "speed", "energy", "none"]);
    const { drive: _, ...old } = replay;
    const first = { ...old, header: { ...header, energy: undefined } } as unknown as Replay;
    expect(fieldsOf([first])).toEqual(["vorticity", "none"]);
  });
});

/** A box in which everything turns as a wave across x: u = 0, v = sin of x. */
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
  const told = { ...header, frames, size, every: 10, velocity: { scale: speed } };
  return { ...replay, header: told, drive: { ...replay.drive!, velocity } };
}

describe("tracers", () => {
  const flow = waving(5, [32, 16], 0.1);

  it("read the velocity between cells, across the borders of the box", () => {
    const [u, v] = velocityAt(flow, 1.5, 8, 3.25);
    expect(u).toBe(0);
    expect(v).toBeCloseTo(0.1, 6);
    expect(velocityAt(flow, 0, 32 + 8, -16)[1]).toBeCloseTo(0.1, 6);
    expect(velocityAt(flow, 0, 31.5, 0)[1]).toBeCloseTo(-0.05 * Math.sin(Math.PI / 16), 3);
  });

  it("go with the flow for as long as it takes, whatever was looked at before", () => {
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

describe("the moment of a replay", () => {
  it("steps to the next whole frame and stops there", () => {
    const moment = new Moment(true);
    moment.move(2.4);
    moment.step(1, 10);
    expect([moment.time, moment.playing]).toEqual([3, false]);
    moment.step(-1, 10);
    expect(moment.time).toBe(2);
    moment.scrub(9.5);
    moment.step(1, 10);
    moment.step(1, 10);
    expect(moment.time).toBe(10);
  });

  it("is looked at as the address says", () => {
    const change = { field: "speed", tracers: true, follow: false, speed: 4 } as const;
    const words = Object.entries(queryOf(change)).filter(([, word]) => word !== null);
    expect(replayViewOf(new URLSearchParams(words as [string, string][]))).toEqual(change);
    expect(replayViewOf(new URLSearchParams("field=heat&pace=3")).speed).toBe(1);
    expect(replayViewOf(new URLSearchParams("field=heat")).field).toBeNull();
  });
});

describe("the keys of a replay", () => {
  // Nothing here draws: an element is what it is within, and the selectors it answers to.
  const element = (selectors: string[], within: object[] = []) => {
    const self = { closest: (asked: string) => (selectors.some((one) => asked.includes(one)) ? self : null) };
    return Object.assign(self, { within }) as unknown as Element;
  };
  const player = {
    contains: (inside: unknown) => (inside as { within: object[] }).within.includes(player),
  } as unknown as Element;

  it("work within the player, and the space bar alone elsewhere", () => {
    const [inside, outside] = [element([], [player]), element([])];
    for (const key of [",", ".", "Home", "End", "ArrowLeft", "ArrowRight"]) {
      expect([keyAction(key, inside, player), keyAction(key, outside, player)]).toEqual([true, false]);
    }
    expect(keyAction(" ", outside, player)).toBe(true);
    expect(keyAction("Home", inside, null)).toBe(false);
  });

  it("are left to what needs them itself", () => {
    const button = element(["button"], [player]);
    expect([keyAction(" ", button, player), keyAction("Home", button, player)]).toEqual([false, true]);
    const choice = element(["select"], [player]);
    expect([keyAction(" ", choice, player), keyAction("End", choice, player)]).toEqual([false, false]);
  });
});
