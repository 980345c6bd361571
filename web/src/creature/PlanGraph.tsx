/** A body at rest, coloured by the segments of its plan. */

import { colourOf } from "../charts/lineStyle";
import type { PlanDrawing } from "../api/types";
import { type PlanPicture, about, edgesOf, nameOf, numberPlace, pictureOf } from "./plan";
import { text } from "./text";

interface Props {
  plan: PlanDrawing;
  selected: number | null;
  onSelect: (segment: number | null) => void;
}

export function PlanGraph({ plan, selected, onSelect }: Props) {
  const picture = pictureOf(plan);
  const { width, height } = picture;
  const grown = plan.segments.flatMap(({ grown }, segment) => (grown > 0 ? [segment] : []));
  const mirrored = plan.nodes.some(({ hand }) => hand < 0);
  return (
    <figure class="plan">
      <svg
        viewBox={`0 0 ${width} ${height}`}
        style={{ maxWidth: `${width}px` }}
        role="group"
        class={selected === null ? "" : "has-selection"}
        aria-label={text.planLabel(plan.nodes.length, grown.length)}
        onPointerLeave={() => onSelect(null)}
      >
        {grown.map((segment) => (
          <Segment key={segment} {...{ plan, picture, segment, onSelect }} selected={segment === selected} />
        ))}
      </svg>
      <figcaption class="quiet small">
        {text.planKey}
        {mirrored && text.mirroredKey}
      </figcaption>
    </figure>
  );
}

interface SegmentProps extends Omit<Props, "selected"> {
  picture: PlanPicture;
  segment: number;
  selected: boolean;
}

/** All copies of a segment, its number beside the first. */
function Segment({ plan, picture, segment, selected, onSelect }: SegmentProps) {
  const { at, scale } = picture;
  const lines = edgesOf(plan, segment)
    .map(([a, b]) => `M${at[a]}L${at[b]}`)
    .join("");
  const rows = plan.nodes.flatMap((node, row) => (node.segment === segment ? [row] : []));
  const place = numberPlace(plan, picture, segment);
  const radius = Math.max(2, Math.min(5, 0.2 * scale));
  const select = () => onSelect(segment);
  return (
    <g
      class={`plan-segment ${selected ? "selected" : ""}`}
      style={{ "--segment": `var(${colourOf(segment)})` }}
      tabIndex={0}
      role="button"
      aria-pressed={selected}
      aria-label={about(segment, plan)}
      onFocus={select}
      onClick={select}
      onPointerEnter={select}
    >
      <path class="reach" d={lines} />
      <path class="line" d={lines} />
      {rows.map((row) => (
        <circle
          key={row}
          class={plan.nodes[row]!.hand < 0 ? "image" : ""}
          cx={at[row]![0]}
          cy={at[row]![1]}
          r={row === 0 ? 1.7 * radius : radius}
        />
      ))}
      {place && (
        <text {...place} dy="0.35em" aria-hidden="true">
          {segment + 1}
        </text>
      )}
      <title>{nameOf(segment)}</title>
    </g>
  );
}
