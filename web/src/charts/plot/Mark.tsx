/** One point of a plot: a link where there is something to see, and what is said of it. */

import type { Line, Point } from "./Plot";

interface MarkProps {
  point: Point;
  line: Line;
  spot: [number, number];
  /** Pointed at, or of a line that is not. */
  look: string;
  /** Whether what it says stands to the left of it. */
  flip: boolean;
  onNear: (point: Point | null) => void;
}

export function Mark({ point, line, spot, look, flip, onNear }: MarkProps) {
  const [name, ...figures] = point.says;
  const kind = point.y === null ? "cross" : point.hollow ? "hollow" : "";
  const common = {
    class: `mark ${kind} ${look}`,
    style: { left: `${spot[0]}px`, top: `${spot[1]}px`, "--colour": `var(${line.colour})` },
    "aria-label": [name, ...figures].join(", "),
    onFocus: () => onNear(point),
    onBlur: () => onNear(null),
  };
  const tip = (
    <span class={`tip ${flip ? "flip" : ""}`} aria-hidden="true">
      <b>{name}</b>
      {figures.map((figure) => (
        <span key={figure}>{figure}</span>
      ))}
      {point.href && <i>Click to watch</i>}
    </span>
  );
  if (!point.href) {
    return (
      <span role="img" tabIndex={0} {...common}>
        {tip}
      </span>
    );
  }
  return (
    <a href={point.href} {...common}>
      {tip}
    </a>
  );
}
