/** The rest shape and the actual shape of a replayed body over time, by joints and edges. */

import type { Replay } from "./replay";

/** (frame, item) values. */
export interface Series {
  items: number;
  values: Float32Array;
}

export interface Shape {
  /** The rest shape, as change from the initial shape. */
  rest: Series;
  /** The actual shape, as change from the initial shape. */
  actual: Series;
}

/** Signed angle of each joint, in rad, from its first edge to its second. */
export function anglesOf(replay: Replay): Shape {
  const { edges, joints } = replay.header;
  const actual = seriesOf(replay, joints.length, (frame) => {
    const along = edges.map((edge) => edgeAt(replay, frame, edge));
    return joints.map(([first, second]) => {
      const [a, b] = [along[first]!, along[second]!];
      return Math.atan2(a[0] * b[1] - a[1] * b[0], a[0] * b[0] + a[1] * b[1]);
    });
  });
  return fromStart({ items: joints.length, values: replay.angles }, actual, (x, start) => x - start);
}

/** Length of each edge, relative to its initial length. */
export function lengthsOf(replay: Replay): Shape {
  const { edges } = replay.header;
  const actual = seriesOf(replay, edges.length, (frame) =>
    edges.map((edge) => Math.hypot(...edgeAt(replay, frame, edge))),
  );
  return fromStart({ items: edges.length, values: replay.lengths }, actual, (x, start) => x / start - 1);
}

function edgeAt({ header, positions }: Replay, frame: number, [a, b]: [number, number]) {
  const part = (k: number) =>
    positions[2 * (frame * header.nodes + b) + k]! - positions[2 * (frame * header.nodes + a) + k]!;
  return [part(0), part(1)] as const;
}

function seriesOf({ header }: Replay, items: number, at: (frame: number) => number[]): Series {
  const values = new Float32Array(header.frames * items);
  for (let frame = 0; frame < header.frames; frame++) values.set(at(frame), frame * items);
  return { items, values };
}

function fromStart(rest: Series, actual: Series, change: (value: number, start: number) => number): Shape {
  const changed = ({ items, values }: Series): Series => ({
    items,
    values: values.map((value, i) => change(value, actual.values[i % items]!)),
  });
  return { rest: changed(rest), actual: changed(actual) };
}

/** The 99.5th percentile of absolute values: the end of a colour scale. */
export function colourLimit(...series: Series[]): number {
  const sizes = Float32Array.from(series.flatMap(({ values }) => [...values.map(Math.abs)])).sort();
  return sizes[Math.floor(0.995 * (sizes.length - 1))] || sizes.at(-1) || 0;
}
