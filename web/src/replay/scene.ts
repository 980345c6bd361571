/** Draw a replay at one time: flow, obstacles, path, body, and the copies of the body in neighbouring periods. */

import { type Replay, solidColumns } from "../decode/replay";
import { type Size, type Theme, prepare } from "../ui/canvas";
import type { FluidPainter } from "./fields";
import { type Point, BODY_INK, bodiesOf, meanOf, positionsAt, splineOf } from "./motion";
import { type Particles, drawTracers } from "./tracers";

/** Cells between points of the grid, which is fixed in the world. */
const GRID = 8;

interface Scene {
  replay: Replay;
  /** Null if no field is shown. */
  painter: FluidPainter | null;
  /** Chains of nodes of each body. */
  bodies: number[][][];
  /** In cells, y upwards. */
  obstacles: Path2D;
  /** The mean position of the first nodes in each frame. */
  path: Point[];
  /** The number of first nodes that the view follows. */
  leader: number;
  follow: boolean;
  /** The brightness of the background. */
  theme: Theme;
  tracers?: Particles | null;
}

const INK = {
  light: {
    body: BODY_INK.light,
    halo: "rgb(255 255 255 / 0.85)",
    faint: "rgb(18 34 44 / 0.28)",
    solid: "rgb(128 140 148)",
  },
  dark: {
    body: BODY_INK.dark,
    halo: "rgb(4 10 14 / 0.75)",
    faint: "rgb(230 240 245 / 0.26)",
    solid: "rgb(92 104 112)",
  },
};

export function sceneOf(
  replay: Replay,
  view: Pick<Scene, "painter" | "follow" | "theme" | "tracers"> & { leader?: number },
): Scene {
  const { frames, edges, nodes } = replay.header;
  const { leader = nodes } = view;
  const mean = (frame: number) => meanOf(positionsAt(replay, frame).slice(0, leader));
  const path = Array.from({ length: frames }, (_, frame) => mean(frame));
  return { replay, bodies: bodiesOf(edges), obstacles: obstaclesOf(replay), path, ...view, leader };
}

/** Solid cells; they overlap a little so that no seam shows. */
function obstaclesOf(replay: Replay): Path2D {
  const obstacles = new Path2D();
  const { size, solid = [] } = replay.header;
  for (const [x, y, count] of solidColumns(solid, size[1])) {
    obstacles.rect(x - 0.51, y - 0.51, 1.02, count + 0.02);
  }
  return obstacles;
}

export function drawScene(canvas: HTMLCanvasElement, size: Size, scene: Scene, time: number) {
  const context = prepare(canvas, size);
  const [width, height] = scene.replay.header.size;
  const scale = size.width / width;
  const points = positionsAt(scene.replay, time);
  const mean = meanOf(points.slice(0, scene.leader));
  const camera = scene.follow ? mean : scene.path[0]!;
  const screen = ([x, y]: Point): Point => [
    (x - camera[0] + width / 2) * scale,
    (camera[1] - y + height / 2) * scale,
  ];
  scene.painter?.paint(context, time, camera, scale);
  drawGrid(context, camera, [width, height], screen, INK[scene.theme].faint);
  drawObstacles(context, scene, camera, scale);
  if (scene.tracers) {
    drawTracers(context, scene.tracers, { time, camera, scale, colour: INK[scene.theme].body });
  }
  const shown = (around: Point, draw: (place: (point: Point) => Point) => void) => {
    for (const [dx, dy] of periodicShifts(around, camera, [width, height])) {
      draw(([x, y]) => screen([x + dx, y + dy]));
    }
  };
  const path = [...scene.path.slice(0, Math.floor(time) + 1), mean];
  shown(mean, (place) => drawPath(context, path.map(place), scene.theme));
  for (const body of scene.bodies) {
    const lines = body.map((chain) => chain.map((node) => points[node]!));
    shown(meanOf(lines.flat()), (place) => {
      const placed = lines.map((line) => line.map(place));
      drawBody(context, placed, Math.min(11, Math.max(3, 0.6 * scale)), scene.theme);
    });
  }
}

/** Shifts by whole worlds that bring the body near the view, and their neighbours. */
function periodicShifts(mean: Point, camera: Point, [width, height]: [number, number]): Point[] {
  const i = Math.round((camera[0] - mean[0]) / width);
  const j = Math.round((camera[1] - mean[1]) / height);
  return [-1, 0, 1].flatMap((di) => [-1, 0, 1].map((dj): Point => [(i + di) * width, (j + dj) * height]));
}

/** The obstacles of the periods that reach into the view. */
function drawObstacles(context: CanvasRenderingContext2D, scene: Scene, camera: Point, scale: number) {
  const [width, height] = scene.replay.header.size;
  const [left, bottom] = [camera[0] - width / 2, camera[1] - height / 2];
  context.fillStyle = INK[scene.theme].solid;
  for (const i of [0, 1]) {
    for (const j of [0, 1]) {
      const x = (Math.floor((left + 0.5) / width) + i) * width - left;
      const y = (Math.floor((bottom + 0.5) / height) + j) * height - bottom;
      context.save();
      context.translate(x * scale, (height - y) * scale);
      context.scale(scale, -scale);
      context.fill(scene.obstacles);
      context.restore();
    }
  }
}

function drawGrid(
  context: CanvasRenderingContext2D,
  camera: Point,
  [width, height]: [number, number],
  screen: (point: Point) => Point,
  colour: string,
) {
  context.fillStyle = colour;
  const first = (centre: number, side: number) => Math.ceil((centre - side / 2) / GRID) * GRID;
  for (let x = first(camera[0], width); x <= camera[0] + width / 2; x += GRID) {
    for (let y = first(camera[1], height); y <= camera[1] + height / 2; y += GRID) {
      const [left, top] = screen([x, y]);
      context.fillRect(left - 1, top - 1, 2, 2);
    }
  }
}

function drawPath(context: CanvasRenderingContext2D, path: Point[], theme: Theme) {
  context.strokeStyle = INK[theme].body;
  context.globalAlpha = 0.55;
  context.lineWidth = 1.25;
  context.beginPath();
  context.arc(...path[0]!, 3, 0, 2 * Math.PI);
  path.forEach((point, i) => (i === 0 ? context.moveTo(...point) : context.lineTo(...point)));
  context.stroke();
  context.globalAlpha = 1;
}

function drawBody(context: CanvasRenderingContext2D, lines: Point[][], width: number, theme: Theme) {
  context.lineCap = context.lineJoin = "round";
  context.beginPath();
  for (const line of lines) {
    context.moveTo(...line[0]!);
    for (const [a, b, end] of splineOf(line)) context.bezierCurveTo(...a, ...b, ...end);
  }
  context.strokeStyle = INK[theme].halo;
  context.lineWidth = width + 3;
  context.stroke();
  context.strokeStyle = INK[theme].body;
  context.lineWidth = width;
  context.stroke();
}
