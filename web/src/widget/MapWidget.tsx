/** The map of an archive in a notebook. */

import { useMemo, useState } from "preact/hooks";
import { ArchiveMap } from "../archive/ArchiveMap";
import { choicesOf, axisOf, namesOf } from "../archive/axes";
import { coloursOf, colourMeasure, colouringOf } from "../archive/colouring";
import { ElitePreview } from "../archive/ElitePreview";
import { type Elite, type Elites, measuresOf, mergeElites } from "../store/elites";
import { Select } from "../ui/Select";
import { type Model, type Shown, useField } from "./model";
import { useKept } from "./poses";
import { text } from "./text";
import { Delaunay } from "d3-delaunay";
import { voronoiLayout } from "../archive/layout";
import { project } from "../archive/projection";
import { PALETTES } from "../ui/colours";

export function MapWidget({ model }: { model: Model }) {
  const [archive] = useField(model, "_archive");
  const [about] = useField(model, "_about");
  const [status] = useField(model, "status");
  const [poses] = useField(model, "_poses");
  const [x, setX] = useField(model, "x");
  const [y, setY] = useField(model, "y");
  const [colour, setColour] = useField(model, "colour");
  const [cells, setCells] = useField(model, "selected");
  const [focused, setFocused] = useState<Elite | null>(null);
  const [marked, setMarked] = useState<number | null>(null);
  useKept(poses);
  const selected = useMemo(() => new Set(cells), [cells]);
  const view = useMemo(() => viewOf(archive, { x, y, colour }), [archive, x, y, colour]);
  const choices = choicesOf(archive);
  const [across, up] = view.axes;
  const select = (cell: number) => {
    setMarked(cell);
    setCells(cells.length === 1 && cells[0] === cell ? [] : [cell]);
  };
  const below = [about, cells.length > 0 && text.selected(cells.length), status].filter(Boolean);
  return (
    <>
      <div class="row controls">
        <Select title={text.across} choices={choices} value={across.name} onChange={setX} />
        <Select title={text.up} choices={choices} value={up.name} onChange={setY} />
        <Select title={text.colour} choices={coloursOf(archive)} value={colour} onChange={setColour} />
      </div>
      <ArchiveMap
        {...view}
        {...{ selected, marked }}
        run={text.run}
        hint={text.hint}
        at={null}
        onFocus={setFocused}
        inset={focused && <ElitePreview sha={focused.creature} />}
        onMark={setMarked}
        onOpen={select}
        onSelect={(chosen) => setCells([...chosen].sort((a, b) => a - b))}
        actions={() => null}
        lists={false}
      />
      <p class="quiet small about">{below.join(" · ")}</p>
    </>
  );
}

interface Choice {
  x: string | null;
  y: string | null;
  colour: string;
}

function viewOf(archive: Shown, { x, y, colour }: Choice) {
  const elites: Elites = mergeElites(archive, new Map());
  const measures = measuresOf({ ...archive, measures: archive.measures ?? {} });
  const names = namesOf(archive, x, y);
  const axes = [
    axisOf(names[0], archive, elites, measures),
    axisOf(names[1], archive, elites, measures),
  ] as const;
  const projection = project(elites, axes, [], cellsOf(archive, names));
  const known = coloursOf(archive).some(([name]) => name === colour);
  const measure = colourMeasure(known ? colour : "fitness", archive, measures, archive.generation);
  const colouring = colouringOf(measure, PALETTES[0]!, projection.tiles);
  return { elites, axes, projection, colouring };
}

/** The Voronoi cells, if both axes are those of the centroids. */
function cellsOf({ axes, centroids }: Shown, names: readonly [string, string]) {
  const [x, y] = names.map((name) => axes.findIndex((axis) => axis.name === name));
  if (!centroids || axes.length !== 2 || x! < 0 || y! < 0) return null;
  return voronoiLayout(
    centroids.map((place) => [place[x!]!, 1 - place[y!]!] as const),
    Delaunay,
  );
}
