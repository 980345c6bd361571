/** A point of a plot with its tooltip; a link if it has a replay. */

import type { Line, Point } from "./Plot";
import { text } from "../curves/text";

interface MarkProps {
  point: Point;
  line: Line;
  spot: [number, number];
  state: string;
  /** True if the tooltip is to the left. */
  flip: boolean;
  onFocusPoint: (point: Point | null) => void;
}

export function Mark({ point, line, spot, state, flip, onFocusPoint }: MarkProps) {
  const [name, ...figures] = point.tooltip;
  const kind = point.y === null ? "cross" : point.hollow ? "hollow" : "";
  const common = {
    class: `mark ${kind} ${state}`,
    style: { left: `${spot[0]}px`, top: `${spot[1]}px`, "--colour": `var(${line.colour})` },
    "aria-label": [name, ...figures].join(", "),
    onFocus: () => onFocusPoint(point),
    onBlur: () => onFocusPoint(null),
  };
  const tip = (
    <span class={`tip ${flip ? "flip" : ""}`} aria-hidden="true">
      <b>{name}</b>
      {figures.map((figure) => (
        <span key={figure}>{figure}</span>
      ))}
      {point.href && <i>{text.clickToWatch}</i>}
    </span>
  );
  if (point.href) {
    return (
      <a href={point.href} {...common}>
        {tip}
      </a>
    );
  }
  return (
    <span role="img" tabIndex={0} {...common}>
      {tip}
    </span>
  );
}
