/** Which two of all that was recorded the map is drawn over. */

import type { Archive } from "../api/types";
import { Select } from "../ui/Select";
import { count } from "../ui/format";
import { choicesOf } from "./axes";

type Names = [x: string, y: string];

interface Props {
  archive: Archive;
  names: Names;
  onChoose: (names: Names) => void;
}

export function AxisSelect({ archive, names: [x, y], onChoose }: Props) {
  const choices = choicesOf(archive);
  return (
    <p class="axis-choice">
      <Select
        title="Across"
        {...{ choices, value: x }}
        onChange={(name) => onChoose(name === y ? [y, x] : [name, y])}
      />
      <Select
        title="Up"
        {...{ choices, value: y }}
        onChange={(name) => onChoose(name === x ? [y, x] : [x, name])}
      />
      <span class="quiet small">{kindOf(archive)}</span>
    </p>
  );
}

/** What the cells are, where the map alone does not show it. */
function kindOf({ kind, cells, axes }: Archive): string {
  if (kind === "cvt") return `${count(cells)} Voronoi cells over ${axes.length} descriptors`;
  if (axes.length === 2) return "";
  const measures = axes.length === 1 ? "1 descriptor" : `${axes.length} descriptors`;
  return `${count(cells)} cells over ${measures}`;
}
