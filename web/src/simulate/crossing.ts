/** The share of recorded poses in which filaments cross, as in `search/crossing.py`. */

/** Most pairs of edges over all poses: of larger bodies not every pose counts. */
const MOST_PAIRS = 2 ** 23;
/** Recorded levels in a unit of place. */
const COARSER = 4;

type Numbers = Float32Array | Int32Array;

interface Body {
  /** (edge, 2) nodes. */
  edges: Int32Array;
  /** (node) 1, or 0 for nodes that have not grown. */
  present: Int32Array;
}

/** `frames` are poses (frame, node, 2) in recorded levels, `start` places (node, 2) in units. */
export function crossing(frames: Numbers, start: Int32Array, body: Body): number {
  const length = start.length;
  const count = frames.length / length;
  const size = body.edges.length / 2;
  const step = Math.min(count, Math.ceil((count * size ** 2) / MOST_PAIRS)) || 1;
  const pairs = apart(body).filter(([one, other]) => !cross(start, body.edges, one!, other!));
  let crossed = 0;
  let shown = 0;
  for (let frame = step - 1; frame < count; frame += step) {
    const levels = frames.subarray(frame * length, (frame + 1) * length);
    const at = Int32Array.from(levels, (level) => Math.floor(level / COARSER));
    crossed += Number(pairs.some(([one, other]) => cross(at, body.edges, one!, other!)));
    shown += 1;
  }
  return Math.fround(crossed / shown);
}

/** Pairs of edges that are present and share no node. */
function apart({ edges, present }: Body): [number, number][] {
  const size = edges.length / 2;
  const there = (edge: number) => present[edges[2 * edge]!] && present[edges[2 * edge + 1]!];
  const found: [number, number][] = [];
  for (let one = 0; one < size; one++) {
    for (let other = 0; other < one; other++) {
      const ends = [edges[2 * one], edges[2 * one + 1]];
      const shared = ends.includes(edges[2 * other]) || ends.includes(edges[2 * other + 1]);
      if (!shared && there(one) && there(other)) found.push([one, other]);
    }
  }
  return found;
}

/** True if the ends of each edge lie on both sides of the other. */
function cross(at: Int32Array, edges: Int32Array, one: number, other: number): boolean {
  return divides(at, edges, one, other) && divides(at, edges, other, one);
}

function divides(at: Int32Array, edges: Int32Array, edge: number, other: number): boolean {
  const base = 2 * edges[2 * edge]!;
  const tip = 2 * edges[2 * edge + 1]!;
  const side = (end: number) => {
    const node = 2 * edges[2 * other + end]!;
    const along = (at[tip]! - at[base]!) * (at[node + 1]! - at[base + 1]!);
    return Math.sign(along - (at[tip + 1]! - at[base + 1]!) * (at[node]! - at[base]!));
  };
  return side(0) * side(1) < 0;
}
