/** Axes, grid and titles of a plot. */

import type { Axis } from "./Plot";
import { place, ticksOf } from "./scale";

export interface Room {
  left: number;
  right: number;
  top: number;
  bottom: number;
}

/** A second axis above, with labels at values of the first one. */
export interface Upper {
  title: string;
  ticks: { at: number; text: string }[];
}

interface Props {
  x: Axis;
  y: Axis;
  room: Room;
  upper: Upper | null;
  shaded: boolean;
}

/** Pixels per label along each axis. */
const [WIDE, HIGH] = [52, 44];

export function Frame({ x, y, room, upper, shaded }: Props) {
  const { left, right, top, bottom } = room;
  const across = (value: number) => left + place(x.scale, value) * (right - left);
  const up = (value: number) => bottom - place(y.scale, value) * (bottom - top);
  const middle = (left + right) / 2;
  return (
    <g class="xy-frame">
      <rect x={left} y={top} width={right - left} height={bottom - top} class={shaded ? "shaded" : ""} />
      {ticksOf(y.scale, (bottom - top) / HIGH).map((value) => (
        <g key={value}>
          <path d={`M${left} ${up(value)}H${right}`} />
          <text x={left - 8} y={up(value) + 4} class="end">
            {y.write(value)}
          </text>
        </g>
      ))}
      {ticksOf(x.scale, (right - left) / WIDE).map((value) => (
        <g key={value}>
          <path d={`M${across(value)} ${top}V${bottom}`} />
          <text x={across(value)} y={bottom + 18}>
            {x.write(value)}
          </text>
        </g>
      ))}
      <path class="base" d={`M${left} ${bottom}H${right}`} />
      <text class="title" x={middle} y={bottom + 40}>
        {x.title}
      </text>
      <text class="title" transform={`translate(14 ${(top + bottom) / 2}) rotate(-90)`}>
        {y.title}
      </text>
      {upper && <UpperAxis {...upper} {...{ across, room, middle }} />}
    </g>
  );
}

type UpperProps = Upper & { across: (value: number) => number; room: Room; middle: number };

function UpperAxis({ title, ticks, across, room, middle }: UpperProps) {
  return (
    <g>
      {apart(ticks, across).map(({ at, text }) => (
        <g key={at}>
          <path class="base" d={`M${across(at)} ${room.top}v-4`} />
          <text x={across(at)} y={room.top - 9}>
            {text}
          </text>
        </g>
      ))}
      <text x={middle} y={room.top - 31}>
        {title}
      </text>
    </g>
  );
}

/** The ticks with enough room, from the last one down. */
function apart(ticks: Upper["ticks"], across: (value: number) => number): Upper["ticks"] {
  return ticks.reduceRight<Upper["ticks"]>((kept, tick) => {
    const crowded = kept[0] && across(kept[0].at) - across(tick.at) < WIDE;
    return crowded ? kept : [tick, ...kept];
  }, []);
}
