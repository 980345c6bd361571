/** The body plan of a creature: the body at rest, and the genes of its segments. */

import { useState } from "preact/hooks";
import * as api from "../api/client";
import type { PlanDrawing, PlanSegment } from "../api/types";
import { colourOf } from "../charts/lineStyle";
import { useFetched } from "../store/fetch";
import { DASH, number } from "../ui/format";
import { Card } from "../ui/Page";
import { Table } from "../ui/Table";
import { PlanGraph } from "./PlanGraph";
import { about, degrees, grownOf, isRoot, kindOf, shortPlaceOf } from "./plan";
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
