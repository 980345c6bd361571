/** The shape of a body over time: what is asked of joints and edges, and what they do. */

import type { Replay } from "./replay";

/** Values of (frame, item), side by side. */
export interface Course {
  items: number;
  values: Float32Array;
}

export interface Shape {
  /** What the drive asks for, less what the body had at the start. */
  asked: Course;
  /** What the body did, less the same. */
  done: Course;
  /** What each item had at the start. */
  start: Float32Array;
}

/** Of each joint the angle in rad from its first edge to its second, turned the shorter way. */
export function anglesOf(replay: Replay): Shape {
  const { header, drive } = replay;
  const joints = header.joints!;
  const done = courseOf(replay, joints.length, (frame) => {
    const along = header.edges.map((edge) => edgeAt(replay, frame, edge));
    return joints.map(([first, second]) => {
      const [a, b] = [along[first]!, along[second]!];
      return Math.atan2(a[0] * b[1] - a[1] * b[0], a[0] * b[0] + a[1] * b[1]);
    });
  });
  return lessStart({ items: joints.length, values: drive!.angles }, done, (x, from) => x - from);
}

/** Of each edge its length, as a part of that at the start. */
export function lengthsOf(replay: Replay): Shape {
  const { edges } = replay.header;
  const done = courseOf(replay, edges.length, (frame) =>
    edges.map((edge) => Math.hypot(...edgeAt(replay, frame, edge))),
  );
  const asked = { items: edges.length, values: replay.drive!.lengths };
  return lessStart(asked, done, (x, from) => x / from - 1);
}

function edgeAt({ header, positions }: Replay, frame: number, [a, b]: [number, number]) {
  const part = (k: number) =>
    positions[2 * (frame * header.nodes + b) + k]! - positions[2 * (frame * header.nodes + a) + k]!;
  return [part(0), part(1)] as const;
}

function courseOf({ header }: Replay, items: number, at: (frame: number) => number[]): Course {
  const values = new Float32Array(header.frames * items);
  for (let frame = 0; frame < header.frames; frame++) values.set(at(frame), frame * items);
  return { items, values };
}

function lessStart(asked: Course, done: Course, change: (value: number, from: number) => number): Shape {
  const start = done.values.slice(0, done.items);
  const changed = ({ items, values }: Course): Course => ({
    items,
    values: values.map((value, i) => change(value, start[i % items]!)),
  });
  return { asked: changed(asked), done: changed(done), start };
}

/** The size that one value in two hundred exceeds: the end of a scale of colours. */
export function sizeOf(...courses: Course[]): number {
  const sizes = Float32Array.from(courses.flatMap(({ values }) => [...values.map(Math.abs)])).sort();
  return sizes[Math.floor(0.995 * (sizes.length - 1))] || sizes.at(-1) || 0;
}
