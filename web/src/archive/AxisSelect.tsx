/** The choice of the two axes of the map. */

import type { Archive } from "../api/types";
import { Select } from "../ui/Select";
import { count } from "../ui/format";
import { choicesOf } from "./axes";
import { text } from "./text";

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
        title={text.across}
        {...{ choices, value: x }}
        onChange={(name) => onChoose(name === y ? [y, x] : [name, y])}
      />
      <Select
        title={text.up}
        {...{ choices, value: y }}
        onChange={(name) => onChoose(name === x ? [y, x] : [x, name])}
      />
      <span class="quiet small">{kindOf(archive)}</span>
    </p>
  );
}

/** A description of the cells, unless the map shows it. */
function kindOf({ kind, cells, axes }: Archive): string {
  if (kind === "cvt") return text.voronoi(count(cells), axes.length);
  if (axes.length === 2) return "";
  return text.grid(count(cells), axes.length);
}
