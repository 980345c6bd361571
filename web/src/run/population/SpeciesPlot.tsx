/** Sizes of species over the generations, stacked; a pointer or the arrow keys read them. */

import { useMemo, useRef, useState } from "preact/hooks";
import type { SpeciesHistory } from "../../api/types";
import { type Size, useSize } from "../../ui/canvas";
import { count } from "../../ui/format";
import { ticksOf } from "../../charts/plot/scale";
import { type Stack, colourOf, pathOf, speciesAt, stackOf } from "./speciesStack";
import { text } from "./text";

const [LEFT, RIGHT, TOP, BOTTOM] = [44, 8, 8, 26];

interface Place {
  i: number;
  /** Members below the pointer; null where a key chose the generation alone. */
  height: number | null;
}

interface Scales {
  last: number;
  x: (i: number) => number;
  y: (members: number) => number;
  placeAt: (x: number, y: number) => Place;
}

function scalesOf({ generation, size }: Stack, width: number, height: number): Scales {
  const last = generation.length - 1;
  const [wide, high] = [width - LEFT - RIGHT, height - TOP - BOTTOM];
  return {
    last,
    x: (i) => LEFT + (last === 0 ? wide / 2 : (i / last) * wide),
    y: (members) => TOP + high * (1 - members / size),
    placeAt: (x, y) => ({
      i: within(Math.round(((x - LEFT) / wide) * last), last),
      height: size * (1 - (y - TOP) / high),
    }),
  };
}

const within = (i: number, last: number) => Math.min(last, Math.max(0, i));

export function SpeciesPlot({ history }: { history: SpeciesHistory }) {
  const host = useRef<HTMLDivElement>(null);
  const size = useSize(host);
  const stack = useMemo(() => stackOf(history), [history]);
  const [place, setPlace] = useState<Place | null>(null);
  const scales = scalesOf(stack, size.width, size.height);
  const { last } = scales;
  const follow = (event: PointerEvent) => {
    const box = host.current!.getBoundingClientRect();
    setPlace(scales.placeAt(event.clientX - box.left, event.clientY - box.top));
  };
  const walk = (event: KeyboardEvent) => {
    const by = { ArrowLeft: -1, ArrowRight: 1, Home: -last, End: last }[event.key];
    if (by === undefined) return;
    event.preventDefault();
    setPlace((old) => ({ i: within((old?.i ?? last) + by, last), height: null }));
  };
  const shown = place && place.i <= last ? place : null;
  const reading = shown && readingOf(stack, shown);
  return (
    <figure class="species">
      <div
        ref={host}
        class="species-plot"
        role="application"
        tabIndex={0}
        aria-label={text.plot(summaryOf(stack))}
        aria-describedby="species-reading"
        onPointerMove={follow}
        onPointerDown={follow}
        onPointerLeave={() => setPlace(null)}
        onKeyDown={walk}
        onBlur={() => setPlace(null)}
      >
        {size.width > 0 && <Areas {...{ stack, size, scales, shown }} lit={reading?.number ?? null} />}
      </div>
      <figcaption id="species-reading" class="small" aria-live="polite">
        {reading ? reading.text : summaryOf(stack)}
      </figcaption>
    </figure>
  );
}

interface AreasProps {
  stack: Stack;
  size: Size;
  scales: Scales;
  shown: Place | null;
  /** The species that is pointed at. */
  lit: number | null;
}

function Areas({ stack, size: { width, height }, scales: { x, y }, shown, lit }: AreasProps) {
  return (
    <svg width={width} height={height} aria-hidden="true">
      <Axes {...{ stack, width, x, y }} />
      {stack.areas.map((area) => (
        <path
          key={area.number}
          d={pathOf(area, x, y)}
          class={lit === area.number ? "lit" : ""}
          style={{ fill: colourOf(area.number) }}
        />
      ))}
      {shown && <path class="cursor" d={`M${x(shown.i)} ${TOP}V${height - BOTTOM}`} />}
    </svg>
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
          {i === 0 ? text.generation(generation[i]) : generation[i]}
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
