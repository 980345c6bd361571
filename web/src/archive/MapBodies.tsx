/** The creatures of a map, swimming in their cells where these are large enough. */

import { useMemo, useRef } from "preact/hooks";
import { useSteps } from "../replay/clock";
import { BODY_INK } from "../replay/motion";
import { traceBody } from "../replay/poses";
import { readArchiveBatch, usePoses } from "../store/poses";
import { type Size, prepare, px, useOnScreen, useTheme } from "../ui/canvas";
import { luminance, sequential } from "../ui/colours";
import { type Colouring, colourPosition } from "./colouring";
import { FADED } from "./mapCanvas";
import type { Projection, Tile } from "./projection";

/** The smallest cells in which a body can be recognised, in pixels, and the most bodies at a time. */
const [MIN_SIDE, MOST] = [15, 600];
/** Brighter cells have dark bodies: where black and white have the same contrast (WCAG 2.2). */
const BRIGHT = 0.18;

interface Props {
  /** The run of the cells; null if they are no cells of a run. */
  run: string | null;
  /** The generation shown; null for the newest. */
  at: number | null;
  projection: Projection;
  colouring: Colouring;
  /** The selected bins; null without a selection. */
  selected: ReadonlySet<number> | null;
  size: Size;
}

export function MapBodies({ run, projection, size, ...props }: Props) {
  const side = Math.sqrt((size.width * size.height) / projection.layout.count);
  if (run === null || side < MIN_SIDE || projection.tiles.size > MOST) return null;
  return <Bodies {...props} {...{ run, projection, size, side }} />;
}

function Bodies({
  run,
  at,
  projection,
  colouring,
  selected,
  size,
  side,
}: Props & { run: string; side: number }) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const theme = useTheme();
  const { tiles, layout } = projection;
  const elites = useMemo(
    () => [...tiles.values()].map(({ cell, elite: { creature } }) => ({ cell, creature })),
    [tiles],
  );
  const poses = usePoses(readArchiveBatch(run, at), elites, false);
  const inks = useMemo(
    () => new Map([...tiles].map(([bin, tile]) => [bin, inkOn(tile, colouring)])),
    [tiles, colouring],
  );
  const last = useRef({ steps: 0, frame: 0 });
  useSteps(useOnScreen(canvas), (steps) => {
    const { current } = last;
    // Every other frame is enough for small bodies that move; other changes are drawn at once.
    const moves = steps !== current.steps;
    current.steps = steps;
    if (!canvas.current || (moves && ++current.frame % 2 > 0)) return;
    const context = prepare(canvas.current, size);
    context.lineJoin = context.lineCap = "round";
    context.lineWidth = Math.max(1.2, side / 22);
    for (const [bin, { elite }] of tiles) {
      const stream = poses.get(elite.creature);
      if (!stream) continue;
      const [x, y] = layout.centre(bin);
      traceBody(context, stream, steps, [x * size.width - side / 2, y * size.height - side / 2, side]);
      context.strokeStyle = inks.get(bin) ?? BODY_INK[theme];
      context.globalAlpha = !selected || selected.has(bin) ? 1 : FADED;
      context.stroke();
    }
  });
  return <canvas data-bodies ref={canvas} style={px({ ...size })} />;
}

/** The colour of a body that is legible on its cell; null if the cell has no colour. */
function inkOn(tile: Tile, colouring: Colouring): string | null {
  const position = colourPosition(colouring, tile);
  if (position === null) return null;
  return luminance(sequential(position, colouring.palette)) > BRIGHT ? BODY_INK.light : BODY_INK.dark;
}
