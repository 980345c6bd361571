/** The map of an archive in a notebook. */

import { useMemo, useState } from "preact/hooks";
import { ArchiveMap } from "../archive/ArchiveMap";
import { choicesOf } from "../archive/axes";
import { coloursOf } from "../archive/colouring";
import { ElitePreview } from "../archive/ElitePreview";
import type { Elite } from "../store/elites";
import { Select } from "../ui/Select";
import { type Model, useField } from "./model";
import { useKept } from "./poses";
import { text } from "./text";
import { viewOf } from "./view";

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
