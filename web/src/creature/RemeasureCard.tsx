/** Measure a creature again and compare with the numbers of its file. */

import { useState } from "preact/hooks";
import * as api from "../api/client";
import { sharedSlug } from "../api/address";
import { messageOf } from "../api/problem";
import type { Measurement } from "../api/types";
import { useRefusal } from "../store/principal";
import { usePolled } from "../store/polling";
import { number, words } from "../ui/format";
import { CheckCard } from "./CheckCard";
import { text } from "./text";

export function RemeasureCard({ sha }: { sha: string }) {
  const { found, idle, running, note, error, start } = useMeasurement(sha);
  const refusal = useRefusal();
  const result = found === "never" ? null : found;
  if (sharedSlug && !result) return null; // Visitors of a share cannot start a measurement.
  const mayStart = !sharedSlug && !refusal && (idle || error !== null);
  return (
    <CheckCard
      {...{ note, error }}
      name="measured"
      title={text.remeasured}
      verdict={result && (result.exact ? ["finished", text.identical] : ["paused", text.differs])}
      button={mayStart ? (result ? text.measureAgain : text.measure) : null}
      onStart={() => void start()}
      running={running ? text.measuring : null}
    >
      {found === "never" && <p class="quiet small">{text.measureAbout}</p>}
      {result && <MeasurementResult {...result} />}
    </CheckCard>
  );
}

/** The measurement of a creature on this server, and a function that starts one. */
function useMeasurement(sha: string) {
  const [turn, setTurn] = useState(0);
  const [starting, setStarting] = useState(false);
  const [failed, setFailed] = useState<string | null>(null);
  const { value, answered, note, error } = usePolled(() => api.readMeasurement(sha), [sha, turn]);
  const start = async () => {
    setFailed(null);
    setStarting(true);
    try {
      await api.startMeasurement(sha);
      setTurn((count) => count + 1);
    } catch (reason) {
      setFailed(messageOf(reason));
    }
    setStarting(false);
  };
  const running = starting || (answered && value === null);
  const found = starting ? null : value;
  return { found, idle: found !== null, running, note, error: failed ?? error, start };
}

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
          <summary>{figures.length === 1 ? text.oneDiffers : text.someDiffer(figures.length)}</summary>
          <table class="plain-table">
            <thead>
              <tr>
                <th scope="col">{text.number}</th>
                <th scope="col">{text.recorded}</th>
                <th scope="col">{text.here}</th>
              </tr>
            </thead>
            <tbody>
              {figures.map(({ name, recorded, measured }) => (
                <tr key={name}>
                  <th scope="row">{words(name)}</th>
                  <td class="figure">{number(recorded, 6)}</td>
                  <td class="figure">{number(measured, 6)}</td>
                </tr>
              ))}
            </tbody>
          </table>
        </details>
      )}
    </>
  );
}
