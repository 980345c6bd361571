/** Measure a creature again and compare with the numbers of its file. */

import * as api from "../api/client";
import { sharedSlug } from "../api/address";
import type { Measurement } from "../api/types";
import { useRefusal } from "../store/principal";
import { number, words } from "../ui/format";
import { type Column, Table } from "../ui/Table";
import { useCheck, CheckCard } from "./CheckCard";
import { Agreement } from "./Mark";
import { text } from "./text";

export function RemeasureCard({ sha }: { sha: string }) {
  const { result, never, running, note, error, start } = useCheck(
    sha,
    api.readMeasurement,
    api.orderMeasurement,
  );
  const refusal = useRefusal();
  if (sharedSlug && !result) return null; // Visitors of a share cannot start a measurement.
  const mayStart = !sharedSlug && !refusal && (never || result || error !== null);
  return (
    <CheckCard
      {...{ note, error }}
      name="measured"
      title={text.remeasured}
      verdict={result && <Agreement same={result.exact} />}
      button={mayStart ? (result ? text.measureAgain : text.measure) : null}
      onStart={() => void start()}
      running={running ? text.measuring : null}
    >
      {never && <p class="quiet small">{text.measureAbout}</p>}
      {result && <MeasurementResult {...result} />}
    </CheckCard>
  );
}

const COLUMNS: Column<Measurement["figures"][number]>[] = [
  { title: text.number, cell: ({ name }) => words(name) },
  { title: text.recorded, cell: ({ recorded }) => number(recorded, 6) },
  { title: text.here, cell: ({ measured }) => number(measured, 6) },
];

function MeasurementResult({ exact, device, recorded_device, fitness, figures, missing }: Measurement) {
  const same = device === recorded_device;
  return (
    <>
      <p class="small">
        {exact
          ? text.allIdentical
          : text.fitnessDiffers(number(fitness.measured, 6), number(fitness.recorded, 6))}{" "}
        {missing.length > 0 && text.notRecorded(missing.length)}{" "}
        {same ? text.sameDevice : text.otherDevice(device, recorded_device)}
      </p>
      {figures.length > 0 && (
        <details>
          <summary>{text.someDiffer(figures.length)}</summary>
          <Table label={text.differences} columns={COLUMNS} rows={figures} keyOf={({ name }) => name} />
        </details>
      )}
    </>
  );
}
