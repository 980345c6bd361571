/** Measure a creature again and compare with the numbers of its file. */

import { useState } from "preact/hooks";
import * as api from "../api/client";
import { sharedSlug } from "../api/address";
import { messageOf } from "../api/problem";
import type { Measurement } from "../api/types";
import { useRefusal } from "../store/principal";
import { usePolled } from "../store/polling";
import { number, words } from "../ui/format";
import { type Column, Table } from "../ui/Table";
import { CheckCard } from "./CheckCard";
import { text } from "./text";

export function RemeasureCard({ sha }: { sha: string }) {
  const { measurement, idle, running, note, error, start } = useMeasurement(sha);
  const refusal = useRefusal();
  const result = measurement === "never" ? null : measurement;
  if (sharedSlug && !result) return null; // Visitors of a share cannot start a measurement.
  const mayStart = !sharedSlug && !refusal && (idle || error !== null);
  return (
    <CheckCard
      {...{ note, error }}
      name="measured"
      title={text.remeasured}
      verdict={result && <Agreement exact={result.exact} />}
      button={mayStart ? (result ? text.measureAgain : text.measure) : null}
      onStart={() => void start()}
      running={running ? text.measuring : null}
    >
      {measurement === "never" && <p class="quiet small">{text.measureAbout}</p>}
      {result && <MeasurementResult {...result} />}
    </CheckCard>
  );
}

function Agreement({ exact }: Pick<Measurement, "exact">) {
  return (
    <span class={`badge ${exact ? "finished" : "paused"}`}>{exact ? text.identical : text.differs}</span>
  );
}

/** The measurement of a creature on this server, and a function that starts one. */
function useMeasurement(sha: string) {
  const [requests, setRequests] = useState(0);
  const [starting, setStarting] = useState(false);
  const [failed, setFailed] = useState<string | null>(null);
  const { value, answered, note, error } = usePolled(() => api.readMeasurement(sha), [sha, requests]);
  const start = async () => {
    setFailed(null);
    setStarting(true);
    try {
      await api.startMeasurement(sha);
      setRequests((count) => count + 1);
    } catch (reason) {
      setFailed(messageOf(reason));
    }
    setStarting(false);
  };
  const running = starting || (answered && value === null);
  const measurement = starting ? null : value;
  return { measurement, idle: measurement !== null, running, note, error: failed ?? error, start };
}

const COLUMNS: Column<Measurement["figures"][number]>[] = [
  { title: text.number, cell: ({ name }) => words(name) },
  { title: text.recorded, cell: ({ recorded }) => number(recorded, 6) },
  { title: text.here, cell: ({ measured }) => number(measured, 6) },
];

function MeasurementResult({ exact, device, recorded_device, fitness, figures }: Measurement) {
  const same = device === recorded_device;
  return (
    <>
      <p class="small">
        {exact
          ? text.allIdentical
          : text.fitnessDiffers(number(fitness.measured, 6), number(fitness.recorded, 6))}{" "}
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
