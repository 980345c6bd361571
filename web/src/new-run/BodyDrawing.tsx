/** A scale drawing of a spec: bodies at rest in their worlds, and target pictures. */

import type { Drawing, DrawnBody } from "../api/types";
import { solidColumns } from "../decode/replay";
import { count, words } from "../ui/format";
import { Picture } from "../ui/Picture";
import { text } from "./text";

export function BodyDrawing({ drawing }: { drawing: Drawing | null }) {
  if (!drawing) return <p class="body-drawing quiet">{text.noDrawing}</p>;
  const { width, height, bodies, pictures } = drawing;
  const view = viewOf(drawing);
  const cut = view.side < Math.min(width, height);
  return (
    <figure class="body-drawing">
      <div
        class={`worlds ${bodies.length > MAX_WHOLE ? "many" : ""}`}
        style={{ "--worlds": Math.min(3, bodies.length) }}
      >
        {bodies.map((body, i) => (
          <World key={i} {...{ body, drawing, view }} id={`world-${i}`} />
        ))}
      </div>
      {pictures.length > 0 && (
        <div class="targets row" role="group" aria-label={text.targets}>
          {pictures.map((picture) => (
            <Picture key={picture.name} of={picture} rgb={BLACK} label={text.picture(picture.name)} />
          ))}
        </div>
      )}
      <figcaption class="quiet small">
        {text.worldScale(count(width), count(height), GRID)}
        {cut && text.viewScale(count(view.side))}
      </figcaption>
    </figure>
  );
}

const BLACK = [0, 0, 0];

/** More bodies than these are drawn without most of the water around them. */
const MAX_WHOLE = 6;
/** Water around a body in such a drawing, in cells. */
const MARGIN = 2;

/** The part of every world that is drawn, in cells: all of it, or a square around the middle with all bodies. */
export function viewOf({ width, height, bodies }: Drawing) {
  const whole = { x: 0, y: 0, width, height, side: Math.max(width, height) };
  if (bodies.length <= MAX_WHOLE) return whole;
  const reach = bodies
    .flatMap(({ positions }) => positions)
    .reduce((most, [x, y]) => Math.max(most, Math.abs(x! - width / 2), Math.abs(y! - height / 2)), 0);
  const side = 2 * Math.ceil(reach + MARGIN);
  if (side >= Math.min(width, height)) return whole;
  return { x: (width - side) / 2, y: (height - side) / 2, width: side, height: side, side };
}

interface WorldProps {
  body: DrawnBody;
  drawing: Drawing;
  view: ReturnType<typeof viewOf>;
  id: string;
}

function World({ body, drawing, view, id: clip }: WorldProps) {
  const { width, height, picture_size: side } = drawing;
  // Width of a thin line, in cells.
  const thin = (view.side / 300) * Math.min(2, drawing.bodies.length);
  const label = `${words(body.name)}: ${caption(body)}`;
  return (
    <div class="world">
      <svg viewBox={`${view.x} ${view.y} ${view.width} ${view.height}`} role="img" aria-label={label}>
        <defs>
          <pattern id={`${clip}-grid`} width={GRID} height={GRID} patternUnits="userSpaceOnUse">
            <path class="grid" d={`M0 0H${GRID}M0 0V${GRID}`} stroke-width={thin} />
          </pattern>
          <clipPath id={clip}>
            <rect width={width} height={height} />
          </clipPath>
        </defs>
        <rect class="water" width={width} height={height} />
        <rect width={width} height={height} fill={`url(#${clip}-grid)`} />
        {side > 0 && (
          <path
            class="target-place"
            d={`M${(width - side) / 2} ${(height - side) / 2}h${side}v${side}h-${side}z`}
            stroke-width={2 * thin}
            stroke-dasharray={`${6 * thin}`}
          />
        )}
        {/* In the world y points upwards, on the screen downwards. */}
        <g clip-path={`url(#${clip})`}>
          <g transform={`matrix(1 0 0 -1 0 ${height})`}>
            <path class="obstacle" d={obstaclesOf(drawing)} />
            {periodicShifts(body, width, height).map(([x, y]) => (
              <Filaments key={`${x} ${y}`} {...{ body, x, y, thin }} />
            ))}
          </g>
        </g>
      </svg>
      <p class="small">
        {words(body.name)} <span class="quiet">{caption(body)}</span>
      </p>
    </div>
  );
}

function Filaments({ body, x, y, thin }: { body: DrawnBody; x: number; y: number; thin: number }) {
  const line = Math.max(2 * thin, 0.28);
  return (
    <g transform={`translate(${x} ${y})`}>
      <path class="filament" d={linesOf(body)} stroke-width={line} />
      <path class="joint" d={dotsOf(body, 5 * thin)} stroke-width={2.1 * line} />
      <path class="branch" d={branchesOf(body)} stroke-width={3 * line} />
    </g>
  );
}

function caption({ nodes, edges, whole }: DrawnBody): string {
  return text.caption(count(nodes), whole ? null : count(edges.length));
}

export const GRID = 8;

/** Solid cells; those in the first column and row reach into the last. */
function obstaclesOf({ solid, width, height }: Drawing): string {
  const columns = solidColumns(solid, height);
  const around = [0, width].flatMap((x) => [0, height].map((y) => [x, y] as const));
  return around
    .flatMap(([dx, dy]) =>
      columns
        .filter(([x, y]) => (dx === 0 || x === 0) && (dy === 0 || y === 0))
        .map(([x, y, n]) => `M${x + dx - 0.5} ${y + dy - 0.5}h1v${n}h-1z`),
    )
    .join("");
}

const at = ([x, y]: number[]) => `${x} ${y}`;

export function linesOf({ positions, edges }: DrawnBody): string {
  return edges.map(([a, b]) => `M${at(positions[a!]!)}L${at(positions[b!]!)}`).join("");
}

/** A dot at every node; none if nodes lie closer than `apart`. */
export function dotsOf(body: DrawnBody, apart: number): string {
  const { positions, edges, nodes } = body;
  if (positions.length < nodes) return "";
  const near = edges.some(([a, b]) => distance(positions[a!]!, positions[b!]!) < apart);
  return near ? "" : dots(positions);
}

export function branchesOf({ positions, edges }: DrawnBody): string {
  const degree = positions.map(() => 0);
  for (const edge of edges) for (const node of edge) degree[node]! += 1;
  return dots(positions.filter((_, i) => degree[i]! > 2));
}

const dots = (positions: number[][]) => positions.map((place) => `M${at(place)}h0`).join("");

function distance([ax, ay]: number[], [bx, by]: number[]): number {
  return Math.hypot(ax! - bx!, ay! - by!);
}

/** Shifts by whole worlds that show a part of the body, because the world is periodic. */
export function periodicShifts({ positions }: DrawnBody, width: number, height: number): [number, number][] {
  const [columns, rows] = [width, height].map((side, axis) =>
    shiftsOf(
      positions.map((at) => at[axis]!),
      side,
    ),
  );
  return columns!.flatMap((x) => rows!.map((y): [number, number] => [x, y]));
}

/** The largest shift, which bounds the number of copies of a body far outside the world. */
const MAX_SHIFT = 2;

function shiftsOf(places: number[], side: number): number[] {
  const [least, most] = [places.reduce((a, b) => Math.min(a, b)), places.reduce((a, b) => Math.max(a, b))];
  const [first, last] = [
    Math.max(-MAX_SHIFT, -Math.floor(most / side)),
    Math.min(MAX_SHIFT, -Math.floor(least / side)),
  ];
  return Array.from({ length: Math.max(0, last - first + 1) }, (_, i) => (first + i) * side);
}
