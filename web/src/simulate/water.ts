/** Fields of the water from its populations, and pushing it; planes are (x, y), as in `fluid/lattice.py`. */

export type Plane = Float32Array;

/** Directions of the lattice, and their weights. */
const DIRECTIONS = [
  [0, 0],
  [1, 0],
  [-1, 0],
  [0, 1],
  [0, -1],
  [1, 1],
  [-1, -1],
  [1, -1],
  [-1, 1],
] as const;
const WEIGHTS = [4 / 9, 1 / 9, 1 / 9, 1 / 9, 1 / 9, 1 / 36, 1 / 36, 1 / 36, 1 / 36];
/** Cells around a push. */
const RADIUS = 3;
const LEVELS = 127;

/** The velocity of each cell along x and y, in cells a step. */
export function velocities(populations: Plane[]): [Plane, Plane] {
  const cells = populations[0]!.length;
  const x = new Float32Array(cells);
  const y = new Float32Array(cells);
  for (let cell = 0; cell < cells; cell++) {
    let density = 1;
    for (let i = 0; i < 9; i++) {
      const value = populations[i]![cell]!;
      density += value;
      x[cell]! += DIRECTIONS[i]![0] * value;
      y[cell]! += DIRECTIONS[i]![1] * value;
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
export function pushed(
  populations: Plane[],
  [width, height]: [number, number],
  [x0, y0]: [number, number],
  [vx, vy]: [number, number],
): void {
  const wrapped = (at: number, size: number) => ((at % size) + size) % size;
  for (let x = Math.round(x0) - RADIUS; x <= x0 + RADIUS; x++) {
    for (let y = Math.round(y0) - RADIUS; y <= y0 + RADIUS; y++) {
      const share = Math.max(0, 1 - Math.hypot(x - x0, y - y0) / RADIUS);
      const cell = wrapped(x, width) * height + wrapped(y, height);
      DIRECTIONS.forEach(([cx, cy], i) => {
        populations[i]![cell]! += 3 * WEIGHTS[i]! * share * (cx * vx + cy * vy);
      });
    }
  }
}
