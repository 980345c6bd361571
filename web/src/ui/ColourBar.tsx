/** A legend: a bar of colours with a name and numbers below. */

interface Props {
  name: string;
  label: string;
  /** The colour at a position from 0 to 1. */
  colourAt: (share: number) => string;
  numbers: string[];
}

const SHARES = Array.from({ length: 17 }, (_, i) => i / 16);

export function ColourBar({ name, label, colourAt, numbers }: Props) {
  const stops = SHARES.map(colourAt).join(", ");
  return (
    <div class="legend" role="img" aria-label={label}>
      <span class="legend-name">{name}</span>
      <span class="legend-bar" style={{ background: `linear-gradient(90deg, ${stops})` }} />
      <span class="legend-numbers">
        {numbers.map((text, i) => (
          <span key={i}>{text}</span>
        ))}
      </span>
    </div>
  );
}
