/** The choice of the axes of the map, of its coloured measure and of the palette. */

import type { Archive } from "../api/types";
import { setQuery } from "../store/router";
import { PALETTES } from "../ui/colours";
import { count, words } from "../ui/format";
import { Select } from "../ui/Select";
import type { ArchiveView } from "./archiveView";
import { choicesOf } from "./axes";
import { coloursOf } from "./colouring";
import { text } from "./text";

const PALETTE_CHOICES = PALETTES.map((name) => [name, words(name)] as const);

export function MapOptions({
  archive,
  view: { axes, colour, palette },
}: {
  archive: Archive;
  view: ArchiveView;
}) {
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
        <span class="quiet small">{kindOf(archive)}</span>
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
function kindOf({ kind, cells, axes }: Archive): string {
  if (kind === "cvt") return text.voronoi(count(cells), axes.length);
  return axes.length === 2 ? "" : text.grid(count(cells), axes.length);
}
