/** Sizes of species over the generations, stacked; a pointer or the arrow keys read them. */

import { useMemo, useRef, useState } from "preact/hooks";
import type { SpeciesHistory } from "../../api/types";
import { useSize } from "../../ui/canvas";
import { count } from "../../ui/format";
import { ticksOf } from "../../charts/plot/scale";
import { type Stack, colourOf, pathOf, speciesAt, stackOf } from "./speciesStack";

const [LEFT, RIGHT, TOP, BOTTOM] = [44, 8, 8, 26];

interface Place {
  i: number;
  /** Members below the pointer; null where a key chose the generation alone. */
  height: number | null;
}

export function SpeciesPlot({ history }: { history: SpeciesHistory }) {
  const host = useRef<HTMLDivElement>(null);
  const { width, height } = useSize(host);
  const stack = useMemo(() => stackOf(history), [history]);
  const [place, setPlace] = useState<Place | null>(null);
  const last = stack.generation.length - 1;
  const [wide, high] = [width - LEFT - RIGHT, height - TOP - BOTTOM];
  const x = (i: number) => LEFT + (last === 0 ? wide / 2 : (i / last) * wide);
  const y = (members: number) => TOP + high * (1 - members / stack.size);
  const follow = (event: PointerEvent) => {
    const box = host.current!.getBoundingClientRect();
    const i = Math.round(((event.clientX - box.left - LEFT) / wide) * last);
    const members = stack.size * (1 - (event.clientY - box.top - TOP) / high);
    setPlace({ i: Math.min(last, Math.max(0, i)), height: members });
  };
  const walk = (event: KeyboardEvent) => {
    const to = { ArrowLeft: -1, ArrowRight: 1, Home: -last, End: last }[event.key];
    if (to === undefined) return;
    event.preventDefault();
    setPlace((old) => ({ i: Math.min(last, Math.max(0, (old?.i ?? last) + to)), height: null }));
  };
  const told = place && place.i <= last ? readingOf(stack, place) : null;
  return (
    <figure class="species">
      <div
        ref={host}
        class="species-plot"
        role="application"
        tabIndex={0}
        aria-label={`Species over generations: ${summaryOf(stack)}. Arrow keys go through the generations.`}
        aria-describedby="species-reading"
        onPointerMove={follow}
        onPointerDown={follow}
        onPointerLeave={() => setPlace(null)}
        onKeyDown={walk}
        onBlur={() => setPlace(null)}
      >
        {width > 0 && (
          <svg width={width} height={height} aria-hidden="true">
            <Axes {...{ stack, width, x, y }} />
            {stack.areas.map((area) => (
              <path
                key={area.number}
                d={pathOf(area, x, y)}
                class={told?.number === area.number ? "lit" : ""}
                style={{ fill: colourOf(area.number) }}
              />
            ))}
            {told && <path class="cursor" d={`M${x(place!.i)} ${TOP}v${high}`} />}
          </svg>
        )}
      </div>
      <figcaption id="species-reading" class="small" aria-live="polite">
        {told ? told.text : summaryOf(stack)}
      </figcaption>
    </figure>
  );
}

interface AxesProps {
  stack: Stack;
  width: number;
  x: (i: number) => number;
  y: (members: number) => number;
}

function Axes({ stack: { generation, size }, width, x, y }: AxesProps) {
  const last = generation.length - 1;
  const shown = [...new Set([0, Math.round(last / 2), last])];
  return (
    <g class="species-axes">
      {ticksOf({ log: false, low: 0, high: size }, 5).map((value) => (
        <g key={value}>
          <path d={`M${LEFT} ${y(value)}H${width - RIGHT}`} />
          <text x={LEFT - 7} y={y(value) + 4} class="end">
            {count(value)}
          </text>
        </g>
      ))}
      {shown.map((i) => (
        <text key={i} x={x(i)} y={y(0) + 18} class={i === 0 ? "" : i === last ? "end" : "middle"}>
          {i === 0 ? `generation ${generation[i]}` : generation[i]}
        </text>
      ))}
    </g>
  );
}

function summaryOf({ generation, areas, size }: Stack): string {
  const last = generation.length - 1;
  const living = areas.filter(({ from, to }) => to[last]! > from[last]!).length;
  const arose = `${count(areas.length)} in all`;
  return `${living} ${living === 1 ? "species lives" : "species live"} in generation ${generation[last]}, ${arose}; a population of ${count(size)}`;
}

function readingOf(stack: Stack, { i, height }: Place): { number: number | null; text: string } {
  const living = stack.areas.filter(({ from, to }) => to[i]! > from[i]!);
  const when = `Generation ${stack.generation[i]}`;
  const found = height === null ? null : speciesAt(stack, i, height);
  if (found) {
    const [number, size] = found;
    return {
      number,
      text: `${when}: species ${number}, ${count(size)} members, of ${living.length} species`,
    };
  }
  const sizes = living
    .map(({ number, from, to }): [number, number] => [number, to[i]! - from[i]!])
    .sort((a, b) => b[1] - a[1])
    .slice(0, 5)
    .map(([number, size]) => `species ${number} ${count(size)}`);
  return { number: null, text: `${when}: ${living.length} species; largest: ${sizes.join(", ")}` };
}
