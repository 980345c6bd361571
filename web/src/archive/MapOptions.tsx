/** Choices of the map: its axes, coloured measure and palette, and ranges of the other descriptors. */

import type { Archive, Run } from "../api/types";
import { valueAt } from "../charts/plot/scale";
import { setQuery } from "../store/router";
import { PALETTES } from "../ui/colours";
import { count, number, words } from "../ui/format";
import { Select } from "../ui/Select";
import { type ArchiveView, setSlice } from "./archiveView";
import { type MapAxis, choicesOf, containerOf, scaleOf } from "./axes";
import { coloursOf } from "./colouring";
import type { Slice } from "./projection";
import { containerText, text } from "./text";

const PALETTE_CHOICES = PALETTES.map((name) => [name, words(name)] as const);

interface Props {
  run: Run;
  archive: Archive;
  view: ArchiveView;
}

export function MapOptions({ run, archive, view: { axes, colour, palette } }: Props) {
  const choices = choicesOf(archive);
  const [x, y] = [axes[0].name, axes[1].name];
  const choose = (axis: "x" | "y") => (name: string) => {
    const [other, old] = axis === "x" ? [y, x] : [x, y];
    // The axes are swapped if the other one is selected.
    setQuery({ x, y, [axis]: name, ...(name === other && { [axis === "x" ? "y" : "x"]: old }) });
  };
  return (
    <div class="row archive-choices">
      <p class="row">
        <Select title={text.across} {...{ choices, value: x }} onChange={choose("x")} />
        <Select title={text.up} {...{ choices, value: y }} onChange={choose("y")} />
        <span class="quiet small">{kindOf(run, archive)}</span>
      </p>
      <p class="row">
        <Select
          title={text.colour}
          choices={coloursOf(archive)}
          value={colour}
          onChange={(name) => setQuery({ colour: name === "fitness" ? null : name })}
        />
        <Select
          title={text.palette}
          choices={PALETTE_CHOICES}
          value={palette}
          onChange={(name) => setQuery({ palette: name === "viridis" ? null : name })}
        />
      </p>
    </div>
  );
}

/** A description of the cells, unless the map shows them. */
function kindOf(run: Run, { kind, cells, axes }: Archive): string {
  if (kind === "pool") return text.places(count(cells), containerText(containerOf(run)?.kind ?? ""));
  if (kind === "cvt") return text.voronoi(count(cells), axes.length);
  return axes.length === 2 ? "" : text.grid(count(cells), axes.length);
}

/** Ranges of the descriptors that are not axes of the map. */
export function Slices({ slices }: { slices: Slice[] }) {
  if (slices.length === 0) return null;
  return (
    <div class="row slices">
      {slices.map((slice) => (
        <SliceControl key={slice.axis.name} {...slice} />
      ))}
    </div>
  );
}

function SliceControl({ axis, from, to }: Slice) {
  const all = from === 0 && to === axis.bins - 1;
  const [low, high] = [number(edgeOf(axis, from)), number(edgeOf(axis, to + 1))];
  const ends = [
    [text.sliceFrom, low, from, (value: number) => setSlice(axis, value, Math.max(value, to))],
    [text.sliceTo, high, to, (value: number) => setSlice(axis, Math.min(from, value), value)],
  ] as const;
  return (
    <fieldset class="slice">
      <legend class="quiet small">{axis.title}</legend>
      {ends.map(([label, raw, value, move], i) => (
        <input
          key={i}
          {...{ type: "range", min: 0, max: axis.bins - 1, value }}
          aria-label={label(axis.title)}
          aria-valuetext={raw}
          onInput={(event) => move(event.currentTarget.valueAsNumber)}
        />
      ))}
      <output class="quiet small">{all ? text.wholeRange : text.range(low, high, axis.unit)}</output>
    </fieldset>
  );
}

/** The raw value at the start of a bin. */
const edgeOf = (axis: MapAxis, bin: number) => valueAt(scaleOf(axis), bin / axis.bins);
