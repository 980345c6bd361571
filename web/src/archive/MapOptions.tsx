/** Choices of the map: its axes, coloured measure and palette, and ranges of the other descriptors. */

import type { Archive, Reprojection, Run } from "../api/types";
import { valueAt } from "../charts/plot/scale";
import { setQuery } from "../store/router";
import { PALETTES } from "../ui/colours";
import { Dropdown, Segments, Select } from "../ui/Select";
import { count, number, percent, words } from "../ui/format";
import { type ArchiveView, TRUST_CHOICES, setSlice } from "./archiveView";
import { type MapAxis, containerOf, scaleOf } from "./axes";
import { coloursOf } from "./colouring";
import type { Slice } from "./projection";
import { setOf, setReprojectedAxes } from "./reprojection";
import { containerText, text } from "./text";

const PALETTE_CHOICES = PALETTES.map((name) => [name, words(name)] as const);

const CREATURES = [
  ["elites", text.presentElites],
  ["history", text.allEntered],
] as const;

export function MapOptions({ archive, view }: { archive: Archive; view: ArchiveView }) {
  const { axes, choices, colour } = view;
  const [x, y] = [axes[0].name, axes[1].name];
  const choose = (axis: "x" | "y") => (name: string) => {
    const [other, old] = axis === "x" ? [y, x] : [x, y];
    // The axes are swapped if the other one is selected.
    const changed = { x, y, [axis]: name, ...(name === other && { [axis === "x" ? "y" : "x"]: old }) };
    if (view.of === "history") setReprojectedAxes(changed);
    else setQuery(changed);
  };
  return (
    <div class="archive-choices">
      <div class="map-choices">
        <Select title={text.across} {...{ choices, value: x }} onChange={choose("x")} />
        <Select title={text.up} {...{ choices, value: y }} onChange={choose("y")} />
        <Select
          title={text.colour}
          choices={coloursOf(archive)}
          value={colour}
          onChange={(name) => setQuery({ colour: name === "fitness" ? null : name })}
        />
        <MoreOptions {...view} />
      </div>
    </div>
  );
}

/** Rarely changed options, in a panel over the map; a dot says that one is changed. */
function MoreOptions({ of, palette, trust }: ArchiveView) {
  const changed = of === "history" || trust !== "" || palette !== PALETTES[0];
  return (
    <Dropdown title={text.more} changed={changed}>
      <Segments label={text.creaturesShown} choices={CREATURES} value={of} onSelect={setOf} />
      {of === "elites" && (
        <Select
          title={text.verdict}
          choices={TRUST_CHOICES}
          value={trust}
          onChange={(verdict) => setQuery({ trust: verdict || null })}
        />
      )}
      <Select
        title={text.palette}
        choices={PALETTE_CHOICES}
        value={palette}
        onChange={(name) => setQuery({ palette: name === PALETTES[0] ? null : name })}
      />
    </Dropdown>
  );
}

/** Loadings of a component that are shown. */
const STRONGEST = 5;

/** The coverage of all creatures over the axes of the map, beside that of the present elites. */
export function ReprojectionFigures({
  archive,
  reprojection,
}: {
  archive: Archive;
  reprojection: Reprojection;
}) {
  const { cells, all_time: all, present, components } = reprojection;
  const titles = new Map(archive.recorded.map(({ name, title }) => [name, title]));
  const figures = ({ elites, coverage, qd_score }: Reprojection["present"]) =>
    text.filled(count(elites), count(cells), percent(coverage), number(qd_score, 4));
  return (
    <div class="reprojection small" role="status">
      <p>{text.reprojected(count(all.creatures), figures(all), figures(present))}</p>
      {components.map(({ name, loadings }) => (
        <p key={name} class="quiet">
          {titles.get(name)}:{" "}
          {Object.entries(loadings)
            .slice(0, STRONGEST)
            .map(([measure, loading]) => `${titles.get(measure) ?? measure} ${signed(loading)}`)
            .join(", ")}
        </p>
      ))}
    </div>
  );
}

const signed = (value: number) => `${value < 0 ? "−" : "+"}${Math.abs(value).toFixed(2)}`;

/** A description of the cells, unless the map shows them. */
export function kindOf(run: Run, { kind, cells, axes }: Archive): string {
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
