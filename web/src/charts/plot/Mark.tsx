/** A point of a plot with its tooltip; a link if it has a replay. */

import type { Line, Point } from "./Plot";
import { text } from "../curves/text";

interface MarkProps {
  point: Point;
  line: Line;
  position: [number, number];
  state: string;
  /** Of the plot: in its right half the tooltip is to the left. */
  width: number;
  onFocusPoint: (point: Point | null) => void;
}

export function Mark({ point, line, position, state, width, onFocusPoint }: MarkProps) {
  const [name, ...figures] = point.tooltip;
  const kind = point.y === null ? "cross" : point.hollow ? "hollow" : "";
  const common = {
    class: `mark ${kind} ${state}`,
    style: { left: `${position[0]}px`, top: `${position[1]}px`, "--colour": `var(${line.colour})` },
    "aria-label": [name, ...figures].join(", "),
    onFocus: () => onFocusPoint(point),
    onBlur: () => onFocusPoint(null),
  };
  const tip = (
    <span class={`tip ${position[0] > width / 2 ? "flip" : ""}`} aria-hidden="true">
      <b>{name}</b>
      {figures.map((figure) => (
        <span key={figure}>{figure}</span>
      ))}
      {point.href && <i>{text.clickToWatch}</i>}
    </span>
  );
  if (!point.href) return <span role="img" tabIndex={0} {...common} children={tip} />;
  return <a href={point.href} {...common} children={tip} />;
}
