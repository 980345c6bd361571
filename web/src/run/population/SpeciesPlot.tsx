/** A stacked plot of species sizes over the generations, read by pointer or arrow keys. */

import { useMemo, useRef, useState } from "preact/hooks";
import type { SpeciesHistory } from "../../api/types";
import { type Size, useSize } from "../../ui/canvas";
import { count } from "../../ui/format";
import { type PlotArea, AxisTitles, Frame } from "../../charts/plot/Frame";
import type { Axis } from "../../charts/plot/Plot";
import { positionOf } from "../../charts/plot/scale";
import { text } from "./text";
import { css, viridis } from "../../ui/colours";

interface Pointed {
  i: number;
  /** Members below the pointer; null if a key selected the generation. */
  height: number | null;
}

const whole = (value: number) => (Number.isInteger(value) ? count(value) : "");

function axesOf({ generation, size }: Stack): { x: Axis; y: Axis } {
  const [first, last] = [generation[0]!, generation.at(-1)!];
  const generations = { log: false, low: first, high: Math.max(last, first + 1) };
  return {
    x: { title: text.generation, scale: generations, format: whole },
    y: { title: text.members, scale: { log: false, low: 0, high: size }, format: whole },
  };
}

const plotAreaOf = ({ width, height }: Size): PlotArea => {
  return { left: 78, right: width - 14, top: 8, bottom: height - 48 };
};

/** The generation and the members at a point of the plot. */
function pointedAt(stack: Stack, area: PlotArea, left: number, top: number): Pointed {
  const { generation, size } = stack;
  const { low, high } = axesOf(stack).x.scale;
  const value = low + ((left - area.left) / (area.right - area.left)) * (high - low);
  const distance = (i: number) => Math.abs(generation[i]! - value);
  const i = [...generation.keys()].reduce((best, i) => (distance(i) < distance(best) ? i : best));
  return { i, height: (size * (area.bottom - top)) / (area.bottom - area.top) };
}

export function SpeciesPlot({ history }: { history: SpeciesHistory }) {
  const host = useRef<HTMLDivElement>(null);
  const size = useSize(host);
  const stack = useMemo(() => stackOf(history), [history]);
  const [pointed, setPointed] = useState<Pointed | null>(null);
  const last = stack.generation.length - 1;
  const follow = (event: PointerEvent) => {
    const box = host.current!.getBoundingClientRect();
    setPointed(pointedAt(stack, plotAreaOf(size), event.clientX - box.left, event.clientY - box.top));
  };
  const moveByKey = (event: KeyboardEvent) => {
    const by = { ArrowLeft: -1, ArrowRight: 1, Home: -last, End: last }[event.key];
    if (by === undefined) return;
    event.preventDefault();
    setPointed((old) => ({ i: Math.min(last, Math.max(0, (old?.i ?? last) + by)), height: null }));
  };
  const shown = pointed && pointed.i <= last ? pointed : null;
  const reading = shown && readingOf(stack, shown);
  return (
    <figure class="species">
      <div
        ref={host}
        class="species-plot"
        role="application"
        tabIndex={0}
        aria-label={text.plot(summaryOf(stack))}
        aria-describedby="species-at-cursor"
        onPointerMove={follow}
        onPointerDown={follow}
        onPointerLeave={() => setPointed(null)}
        onKeyDown={moveByKey}
        onBlur={() => setPointed(null)}
      >
        {size.width > 0 && (
          <>
            <Areas {...{ stack, size, shown }} lit={reading?.number ?? null} />
            <AxisTitles {...axesOf(stack)} area={plotAreaOf(size)} topAxis={null} />
          </>
        )}
      </div>
      <figcaption id="species-at-cursor" class="small" aria-live="polite">
        {reading ? reading.text : summaryOf(stack)}
      </figcaption>
    </figure>
  );
}

interface AreasProps {
  stack: Stack;
  size: Size;
  shown: Pointed | null;
  lit: number | null;
}

function Areas({ stack, size, shown, lit }: AreasProps) {
  const area = plotAreaOf(size);
  const axes = axesOf(stack);
  const x = (i: number) =>
    area.left + positionOf(axes.x.scale, stack.generation[i]!) * (area.right - area.left);
  const y = (members: number) => area.bottom - positionOf(axes.y.scale, members) * (area.bottom - area.top);
  return (
    <svg width={size.width} height={size.height} aria-hidden="true">
      <Frame {...axes} area={area} topAxis={null} shaded={false} />
      {stack.areas.map((species) => (
        <path
          key={species.number}
          d={pathOf(species, x, y)}
          class={`species-area ${lit === species.number ? "lit" : ""}`}
          style={{ fill: colourOf(species.number) }}
        />
      ))}
      {shown && <path class="cursor" d={`M${x(shown.i)} ${area.top}V${area.bottom}`} />}
    </svg>
  );
}

const livingIn = ({ areas }: Stack, i: number) => areas.filter(({ from, to }) => to[i]! > from[i]!);

function summaryOf(stack: Stack): string {
  const last = stack.generation.length - 1;
  const [living, all] = [livingIn(stack, last).length, stack.areas.length];
  return text.summary(living, stack.generation[last]!, count(all), count(stack.size));
}

function readingOf(stack: Stack, { i, height }: Pointed): { number: number | null; text: string } {
  const living = livingIn(stack, i);
  const generation = stack.generation[i]!;
  const species = height === null ? null : speciesAt(stack, i, height);
  if (species) {
    const [number, size] = species;
    return { number, text: text.oneSpecies(generation, number, count(size), living.length) };
  }
  const sizes = living
    .map(({ number, from, to }): [number, number] => [number, to[i]! - from[i]!])
    .sort((a, b) => b[1] - a[1])
    .slice(0, 5)
    .map(([number, size]) => text.sizeOf(number, count(size)));
  return { number: null, text: text.allSpecies(generation, living.length, sizes.join(", ")) };
}

interface Area {
  number: number;
  /** Lower and upper edge in each generation, from 0 to the size of the population. */
  from: number[];
  to: number[];
}

interface Stack {
  generation: readonly number[];
  areas: Area[];
  size: number;
}

/** The oldest species are at the bottom, so that a living species keeps its neighbours. */
export function stackOf({ generation, number, members }: SpeciesHistory): Stack {
  const sizes = number.map((row, i) => new Map(row.map((each, k) => [each, members[i]![k]!])));
  const all = [...new Set(number.flat())].sort((a, b) => a - b);
  const tops = generation.map(() => 0);
  const areas = all.map((each) => {
    const from = [...tops];
    sizes.forEach((size, i) => (tops[i]! += size.get(each) ?? 0));
    return { number: each, from, to: [...tops] };
  });
  return { generation, areas, size: Math.max(1, ...tops) };
}

/** The golden section makes the lightness of successive species differ most. */
const GOLDEN = 0.61803398875;

/** The viridis colour of a species, which stays the same in every plot. */
export function colourOf(number: number): string {
  return css(viridis(0.08 + 0.88 * ((number * GOLDEN) % 1)));
}

/** Number and size of the species at a height in a generation. */
export function speciesAt(stack: Stack, i: number, height: number): [number, number] | null {
  const area = stack.areas.find(({ from, to }) => height >= from[i]! && height < to[i]!);
  return area ? [area.number, area.to[i]! - area.from[i]!] : null;
}

/** The outline of an area, along its upper edge and back along its lower edge. */
export function pathOf({ from, to }: Area, x: (i: number) => number, y: (v: number) => number): string {
  const [first, last] = extentOf({ from, to });
  const there = range(first, last).map((i) => `${x(i).toFixed(1)} ${y(to[i]!).toFixed(1)}`);
  const back = range(first, last).map((i) => `${x(i).toFixed(1)} ${y(from[i]!).toFixed(1)}`);
  return `M${there.join("L")}L${back.reverse().join("L")}Z`;
}

/** First and last generation of the outline: one before the species and one after. */
export function extentOf({ from, to }: Pick<Area, "from" | "to">): [first: number, last: number] {
  const alive = to.map((top, i) => top > from[i]!);
  return [Math.max(0, alive.indexOf(true) - 1), Math.min(to.length - 1, alive.lastIndexOf(true) + 1)];
}

const range = (first: number, last: number) => Array.from({ length: last - first + 1 }, (_, k) => first + k);
