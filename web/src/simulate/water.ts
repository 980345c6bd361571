/** Fields of the water from its populations, and pushing it; planes are (x, y), as in `fluid/lattice.py`. */

export type Plane = Float32Array;
/** A place or a vector, in cells. */
export type Place = [x: number, y: number];

/** Directions of the lattice along x and y, and their weights. */
const CX = [0, 1, -1, 0, 0, 1, -1, 1, -1];
const CY = [0, 0, 0, 1, -1, 1, -1, -1, 1];
const WEIGHTS = [4 / 9, 1 / 9, 1 / 9, 1 / 9, 1 / 9, 1 / 36, 1 / 36, 1 / 36, 1 / 36];
/** Cells around a push or a force. */
const RADIUS = 3;
const LEVELS = 127;
/** Cells beside a node whose water it moves. */
const REACH = 2;
/** Places along each axis where another creature may begin. */
const GRID = 16;

/** Forces on the water besides those of bodies; empty where there are none. */
export interface Forces {
  uniform: ArrayLike<number>;
  /** In each cell, across rows and along them. */
  across: ArrayLike<number>;
  along: ArrayLike<number>;
  walls: ArrayLike<number>;
}

const NONE: Forces = { uniform: [], across: [], along: [], walls: [] };

/** The velocity of each cell along x and y, in cells a step. */
export function velocities(populations: Plane[], forces: Forces = NONE): [Plane, Plane] {
  const cells = populations[0]!.length;
  const { uniform, across, along, walls } = forces;
  const x = new Float32Array(cells);
  const y = new Float32Array(cells);
  for (let cell = 0; cell < cells; cell++) {
    let density = 1;
    for (let i = 0; i < 9; i++) {
      const value = populations[i]![cell]!;
      density += value;
      x[cell]! += CX[i]! * value;
      y[cell]! += CY[i]! * value;
    }
    // Half a step of the force has acted, as in `fluid.moving`; walls are at rest.
    if (!walls[cell]) {
      x[cell]! += ((uniform[0] ?? 0) + (across[cell] ?? 0)) / 2;
      y[cell]! += ((uniform[1] ?? 0) + (along[cell] ?? 0)) / 2;
    }
    x[cell]! /= density;
    y[cell]! /= density;
  }
  return [x, y];
}

/** ∂u_y/∂x − ∂u_x/∂y by central differences, in 1/step. */
export function vorticity([ux, uy]: [Plane, Plane], [width, height]: [number, number]): Plane {
  const found = new Float32Array(ux.length);
  for (let x = 0; x < width; x++) {
    const [before, after] = [((x + width - 1) % width) * height, ((x + 1) % width) * height];
    for (let y = 0; y < height; y++) {
      const [below, above] = [(y + height - 1) % height, (y + 1) % height];
      const along = uy[after + y]! - uy[before + y]!;
      found[x * height + y] = (along - (ux[x * height + above]! - ux[x * height + below]!)) / 2;
    }
  }
  return found;
}

/** Planes as levels of a scale, which is their largest value. */
export function quantised(planes: Plane[]): [Int8Array, number] {
  let scale = 1e-9;
  for (const plane of planes) for (const value of plane) scale = Math.max(scale, Math.abs(value));
  const levels = new Int8Array(planes.length * planes[0]!.length);
  planes.forEach((plane, k) => {
    plane.forEach((value, cell) => {
      levels[k * plane.length + cell] = Math.round((value / scale) * LEVELS);
    });
  });
  return [levels, scale];
}

/** Add a velocity to the water around a place, the more the nearer. */
export function pushed(populations: Plane[], size: [number, number], place: Place, velocity: Place): void {
  push(populations, around(size, place), velocity);
}

/** Let a force act on the water around a place for one step: the momentum of the water grows by it. */
export function forced(populations: Plane[], size: [number, number], place: Place, force: Place): void {
  const cells = around(size, place);
  const total = cells.reduce((sum, [, share]) => sum + share, 0);
  push(populations, cells, [force[0] / total, force[1] / total]);
}

function push(populations: Plane[], cells: [number, number][], [vx, vy]: Place): void {
  for (const [cell, share] of cells) {
    WEIGHTS.forEach((weight, i) => {
      populations[i]![cell]! += 3 * weight * share * (CX[i]! * vx + CY[i]! * vy);
    });
  }
}

/** The cells around a place, each with a share from 0 to 1 that decreases with the distance. */
function around([width, height]: [number, number], [x0, y0]: Place): [cell: number, share: number][] {
  const found: [number, number][] = [];
  for (let x = Math.round(x0) - RADIUS; x <= x0 + RADIUS; x++) {
    for (let y = Math.round(y0) - RADIUS; y <= y0 + RADIUS; y++) {
      const share = Math.max(0, 1 - Math.hypot(x - x0, y - y0) / RADIUS);
      found.push([wrap(x, width) * height + wrap(y, height), share]);
    }
  }
  return found;
}

/**
 * The place of a grid over the water that is the farthest from all positions (node, 2), for a body whose nodes
 * stand around it. Null if the body would reach a wall (a plane, or empty) everywhere.
 */
export function freest(
  positions: Float32Array,
  [width, height]: [number, number],
  body: Float32Array,
  walls: ArrayLike<number>,
): Place | null {
  let best: Place | null = null;
  let farthest = -1;
  for (let i = 0; i < GRID ** 2; i++) {
    const place: Place = [(Math.floor(i / GRID) * width) / GRID, ((i % GRID) * height) / GRID];
    let nearest = Infinity;
    for (let node = 0; node < positions.length; node += 2) {
      const gap = shortest([positions[node]! - place[0], positions[node + 1]! - place[1]], [width, height]);
      nearest = Math.min(nearest, Math.hypot(...gap));
    }
    if (nearest <= farthest || reaches(body, place, [width, height], walls)) continue;
    [farthest, best] = [nearest, place];
  }
  return best;
}

/** True if a cell whose water a body at a place would move is solid. */
function reaches(
  body: Float32Array,
  [x0, y0]: Place,
  [width, height]: [number, number],
  walls: ArrayLike<number>,
): boolean {
  if (walls.length === 0) return false;
  for (let node = 0; node < body.length; node += 2) {
    const [x, y] = [Math.round(x0 + body[node]!), Math.round(y0 + body[node + 1]!)];
    for (let cell = 0; cell < (2 * REACH + 1) ** 2; cell++) {
      const [dx, dy] = [Math.floor(cell / (2 * REACH + 1)) - REACH, (cell % (2 * REACH + 1)) - REACH];
      if (walls[wrap(x + dx, width) * height + wrap(y + dy, height)]) return true;
    }
  }
  return false;
}

/** The length of the side that water needs for a body, turned any way: it must not reach its own image. */
export function sideFor(body: Float32Array): number {
  let longest = 0;
  for (let i = 0; i < body.length; i += 2) {
    for (let j = 0; j < i; j += 2) {
      longest = Math.max(longest, Math.hypot(body[i]! - body[j]!, body[i + 1]! - body[j + 1]!));
    }
  }
  return Math.ceil(longest) + 2 * REACH;
}

/** The shortest of the ways between two places of a world that repeats. */
export const shortest = ([x, y]: Place, [width, height]: [number, number]): Place => [
  wrap(x + width / 2, width) - width / 2,
  wrap(y + height / 2, height) - height / 2,
];

const wrap = (at: number, size: number) => ((at % size) + size) % size;
