/** What colours mean: a bar of them, named, with numbers at even distances beneath. */

interface Props {
  name: string;
  /** Its words for who does not see it. */
  label: string;
  /** The colour at a share of the way, from 0 to 1. */
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
