/** Ranges of the descriptors that are not axes of the map. */

import { valueAt } from "../charts/plot/scale";
import { number } from "../ui/format";
import { type MapAxis, scaleOf } from "./axes";
import type { Slice } from "./projection";
import { text } from "./text";

interface Props {
  slices: Slice[];
  onChange: (slice: Slice, from: number, to: number) => void;
}

export function Slices({ slices, onChange }: Props) {
  if (slices.length === 0) return null;
  return (
    <div class="row slices">
      {slices.map((slice) => (
        <SliceControl key={slice.axis.name} slice={slice} onChange={onChange} />
      ))}
    </div>
  );
}

function SliceControl({ slice, onChange }: { slice: Slice; onChange: Props["onChange"] }) {
  const { axis, from, to } = slice;
  const all = from === 0 && to === axis.bins - 1;
  const [low, high] = [number(edgeOf(axis, from)), number(edgeOf(axis, to + 1))];
  const ends = [
    [text.sliceFrom, low, from, (value: number) => onChange(slice, value, Math.max(value, to))],
    [text.sliceTo, high, to, (value: number) => onChange(slice, Math.min(from, value), value)],
  ] as const;
  return (
    <fieldset class="slice">
      <legend>{axis.title}</legend>
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
