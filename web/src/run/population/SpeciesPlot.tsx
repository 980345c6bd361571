/** A stacked plot of species sizes over the generations, read by pointer or arrow keys. */

import { useMemo, useRef, useState } from "preact/hooks";
import type { SpeciesHistory } from "../../api/types";
import { type Size, useSize } from "../../ui/canvas";
import { count } from "../../ui/format";
import { type Room, AxisTitles, Frame } from "../../charts/plot/Frame";
import type { Axis } from "../../charts/plot/Plot";
import { positionOf } from "../../charts/plot/scale";
import { type Stack, colourOf, pathOf, speciesAt, stackOf } from "./speciesStack";
import { text } from "./text";

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

const roomOf = ({ width, height }: Size): Room => {
  return { left: 78, right: width - 14, top: 8, bottom: height - 48 };
};

/** The generation and the members at a point of the plot. */
function pointedAt(stack: Stack, room: Room, left: number, top: number): Pointed {
  const { generation, size } = stack;
  const { low, high } = axesOf(stack).x.scale;
  const value = low + ((left - room.left) / (room.right - room.left)) * (high - low);
  const distance = (i: number) => Math.abs(generation[i]! - value);
  const i = [...generation.keys()].reduce((best, i) => (distance(i) < distance(best) ? i : best));
  return { i, height: (size * (room.bottom - top)) / (room.bottom - room.top) };
}

export function SpeciesPlot({ history }: { history: SpeciesHistory }) {
  const host = useRef<HTMLDivElement>(null);
  const size = useSize(host);
  const stack = useMemo(() => stackOf(history), [history]);
  const [pointed, setPointed] = useState<Pointed | null>(null);
  const last = stack.generation.length - 1;
  const follow = (event: PointerEvent) => {
    const box = host.current!.getBoundingClientRect();
    setPointed(pointedAt(stack, roomOf(size), event.clientX - box.left, event.clientY - box.top));
  };
  const walk = (event: KeyboardEvent) => {
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
        onKeyDown={walk}
        onBlur={() => setPointed(null)}
      >
        {size.width > 0 && (
          <>
            <Areas {...{ stack, size, shown }} lit={reading?.number ?? null} />
            <AxisTitles {...axesOf(stack)} room={roomOf(size)} upper={null} />
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
  const room = roomOf(size);
  const axes = axesOf(stack);
  const x = (i: number) =>
    room.left + positionOf(axes.x.scale, stack.generation[i]!) * (room.right - room.left);
  const y = (members: number) => room.bottom - positionOf(axes.y.scale, members) * (room.bottom - room.top);
  return (
    <svg width={size.width} height={size.height} aria-hidden="true">
      <Frame {...axes} room={room} upper={null} shaded={false} />
      {stack.areas.map((area) => (
        <path
          key={area.number}
          d={pathOf(area, x, y)}
          class={`species-area ${lit === area.number ? "lit" : ""}`}
          style={{ fill: colourOf(area.number) }}
        />
      ))}
      {shown && <path class="cursor" d={`M${x(shown.i)} ${room.top}V${room.bottom}`} />}
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
  const found = height === null ? null : speciesAt(stack, i, height);
  if (found) {
    const [number, size] = found;
    return { number, text: text.oneSpecies(generation, number, count(size), living.length) };
  }
  const sizes = living
    .map(({ number, from, to }): [number, number] => [number, to[i]! - from[i]!])
    .sort((a, b) => b[1] - a[1])
    .slice(0, 5)
    .map(([number, size]) => text.sizeOf(number, count(size)));
  return { number: null, text: text.allSpecies(generation, living.length, sizes.join(", ")) };
}
