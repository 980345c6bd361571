/** What the colours of the map mean, in numbers. */

import { css, viridis } from "../colours";
import { count, number } from "../format";

const STOPS = Array.from({ length: 17 }, (_, i) => css(viridis(i / 16))).join(", ");

interface Props {
  label: string;
  range: [number, number];
  whole: boolean;
}

export function Legend({ label, range: [low, high], whole }: Props) {
  const write = whole ? count : number;
  return (
    <div class="legend" role="img" aria-label={`${label} from ${write(low)} to ${write(high)}`}>
      <span class="legend-name">{label}</span>
      <span class="legend-bar" style={{ background: `linear-gradient(90deg, ${STOPS})` }} />
      <span class="legend-numbers">
        {[low, (low + high) / 2, high].map((value, i) => (
          <span key={i}>{write(value)}</span>
        ))}
      </span>
    </div>
  );
}
