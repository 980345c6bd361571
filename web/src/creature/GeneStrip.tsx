/** Numeric genes from −1 to 1 as bars. */

import { useMemo } from "preact/hooks";
import type { Vector } from "../api/types";
import { decodeFloats } from "../decode/floats";
import { count, number, percent } from "../ui/format";
import { text } from "./text";

/** With more genes, each bar shows the largest of several. */
const MAX_BARS = 400;

export function GeneStrip({ genes }: { genes: Vector }) {
  const values = useMemo(() => decodeFloats(genes.values), [genes]);
  const bars = useMemo(() => barsOf(values), [values]);
  const meanSize = values.reduce((sum, value) => sum + Math.abs(value), 0) / (values.length || 1);
  const shareAtBounds = values.filter((value) => Math.abs(value) >= 1).length / (values.length || 1);
  const summary = text.genesSummary(count(values.length), number(meanSize));
  return (
    <figure class="genes">
      <svg viewBox={`0 -1 ${bars.length} 2`} preserveAspectRatio="none" role="img" aria-label={summary}>
        <path class="positive" d={pathOf(bars, (value) => Math.max(0, value))} />
        <path class="negative" d={pathOf(bars, (value) => Math.min(0, value))} />
        <path class="zero" d={`M0,0H${bars.length}`} />
      </svg>
      <figcaption class="row">
        <span class="key positive">{text.positiveGenes}</span>
        <span class="key negative">{text.negativeGenes}</span>
        <span class="quiet">
          {summary}
          {shareAtBounds > 0 && text.atBounds(percent(shareAtBounds))}
        </span>
      </figcaption>
    </figure>
  );
}

/** At most `MAX_BARS` values, each the largest in size of those that it represents. */
export function barsOf(values: Float32Array): number[] {
  const perBar = Math.max(1, Math.ceil(values.length / MAX_BARS));
  return Array.from({ length: Math.ceil(values.length / perBar) }, (_, k) =>
    values
      .subarray(k * perBar, (k + 1) * perBar)
      .reduce((most, value) => (Math.abs(value) > Math.abs(most) ? value : most), 0),
  );
}

function pathOf(bars: number[], part: (value: number) => number): string {
  return bars
    .map((value, i) => [i, part(value)] as const)
    .filter(([, value]) => value !== 0)
    .map(([i, value]) => `M${i + 0.1},0V${-value.toFixed(4)}h0.8V0z`)
    .join("");
}
