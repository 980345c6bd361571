/** A run's QD score in a line of text's height. */

interface Props {
  values: number[];
  label: string;
}

const [WIDTH, HEIGHT, MARGIN] = [96, 24, 2];

export function Sparkline({ values, label }: Props) {
  if (values.length < 2) return <span class="quiet">–</span>;
  const low = Math.min(...values);
  const span = Math.max(...values) - low || 1;
  const points = values.map((value, i) => {
    const x = MARGIN + ((WIDTH - 2 * MARGIN) * i) / (values.length - 1);
    const y = HEIGHT - MARGIN - ((HEIGHT - 2 * MARGIN) * (value - low)) / span;
    return `${x.toFixed(1)},${y.toFixed(1)}`;
  });
  const [x, y] = points.at(-1)!.split(",");
  return (
    <svg class="sparkline" viewBox={`0 0 ${WIDTH} ${HEIGHT}`} role="img" aria-label={label}>
      <polyline points={points.join(" ")} />
      <circle cx={x} cy={y} r="2" />
    </svg>
  );
}
