/** The body plan of a creature: the body at rest, and the genes of its segments. */

import { useState } from "preact/hooks";
import * as api from "../api/client";
import type { PlanDrawing, PlanSegment } from "../api/types";
import { colourOf } from "../charts/lineStyle";
import { useFetched } from "../store/fetch";
import { DASH, number } from "../ui/format";
import { Card } from "../ui/Page";
import { Table } from "../ui/Table";
import {
  type PlanPicture,
  about,
  degrees,
  grownOf,
  isRoot,
  kindOf,
  shortPlaceOf,
  edgesOf,
  nameOf,
  numberPlace,
  pictureOf,
} from "./plan";
import { text } from "./text";
import "./plan.css";

export function PlanCard({ sha }: { sha: string }) {
  const { value: plan, error } = useFetched(() => api.readPlan(sha), [sha]);
  const [selected, setSelected] = useState<number | null>(null);
  return (
    <Card id="plan" title={text.plan}>
      {error && <p class="wrong-text small">{error}</p>}
      {!plan && !error && <p class="quiet loading">{text.loadingPlan}</p>}
      {plan && (
        <>
          <PlanGraph {...{ plan, selected }} onSelect={setSelected} />
          <p class="plan-about small" aria-live="polite">
            {selected === null ? <span class="quiet">{text.planHint}</span> : about(selected, plan)}
          </p>
          <SegmentTable {...{ plan, selected }} onSelect={setSelected} />
        </>
      )}
    </Card>
  );
}

interface TableProps {
  plan: PlanDrawing;
  selected: number | null;
  onSelect: (segment: number | null) => void;
}

interface Row extends PlanSegment {
  index: number;
}

function SegmentTable({ plan, selected, onSelect }: TableProps) {
  const rows = plan.segments.map((segment, index): Row => ({ ...segment, index }));
  const name = ({ index }: Row) => (
    <button
      type="button"
      class="plain plan-name"
      style={{ "--segment": `var(${colourOf(index)})` }}
      aria-pressed={index === selected}
      onFocus={() => onSelect(index)}
      onClick={() => onSelect(index)}
      onPointerEnter={() => onSelect(index)}
    >
      {index + 1}
    </button>
  );
  const grown = (row: Row) =>
    row.grown > 0 ? row.grown : <span class="warning-text">{grownOf(row, plan)}</span>;
  return (
    <Table
      label={text.segmentsOfPlan}
      kind="plan-table"
      keyOf={({ index }) => index}
      rowKind={({ index }) => (index === selected ? "selected" : "")}
      rows={rows}
      columns={[
        { title: text.segmentTitle, cell: name },
        { title: text.inBodyTitle, cell: grown },
        { title: text.attachedTitle, cell: shortPlaceOf },
        { title: text.nodesTitle, cell: ({ nodes }) => nodes },
        { title: text.angleTitle, cell: (row) => (isRoot(row) ? DASH : degrees(row.angle)) },
        { title: text.curlTitle, cell: ({ ring, curl }) => (ring ? DASH : degrees(curl)) },
        { title: text.stiffnessTitle, cell: ({ stiffness }) => number(stiffness, 2) },
        { title: text.kindTitle, cell: (row) => kindOf(row) || DASH },
      ]}
    />
  );
}

interface Props {
  plan: PlanDrawing;
  selected: number | null;
  onSelect: (segment: number | null) => void;
}

function PlanGraph({ plan, selected, onSelect }: Props) {
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
