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
        <One key={slice.axis.name} slice={slice} onChange={onChange} />
      ))}
    </div>
  );
}

function One({ slice, onChange }: { slice: Slice; onChange: Props["onChange"] }) {
  const { axis, from, to } = slice;
  const all = from === 0 && to === axis.bins - 1;
  const [low, high] = [number(edgeOf(axis, from)), number(edgeOf(axis, to + 1))];
  const common = { type: "range", min: 0, max: axis.bins - 1 } as const;
  return (
    <fieldset class="slice">
      <legend>{axis.title}</legend>
      <input
        {...common}
        aria-label={text.sliceFrom(axis.title)}
        aria-valuetext={low}
        value={from}
        onInput={({ currentTarget: { valueAsNumber } }) =>
          onChange(slice, valueAsNumber, Math.max(valueAsNumber, to))
        }
      />
      <input
        {...common}
        aria-label={text.sliceTo(axis.title)}
        aria-valuetext={high}
        value={to}
        onInput={({ currentTarget: { valueAsNumber } }) =>
          onChange(slice, Math.min(from, valueAsNumber), valueAsNumber)
        }
      />
      <output class="quiet small">{all ? text.wholeRange : text.range(low, high, axis.unit)}</output>
    </fieldset>
  );
}

/** The raw value at the start of a bin. */
const edgeOf = (axis: MapAxis, bin: number) => valueAt(scaleOf(axis), bin / axis.bins);
