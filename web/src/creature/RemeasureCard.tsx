/** Measure a creature again and compare with the numbers of its file. */

import { useEffect, useState } from "preact/hooks";
import * as api from "../api/client";
import { sharedSlug } from "../api/address";
import { messageOf } from "../api/problem";
import type { Measurement } from "../api/types";
import { useRefusal } from "../store/principal";
import { poll } from "../store/polling";
import { number, words } from "../ui/format";
import { text } from "./text";

type State = "unknown" | "never" | "underway" | Measurement;

export function RemeasureCard({ sha }: { sha: string }) {
  const { state, note, error, start } = useMeasurement(sha);
  const refusal = useRefusal();
  const found = typeof state === "string" ? null : state;
  if (sharedSlug && !found) return null; // Visitors of a share cannot start a measurement.
  const idle = state !== "unknown" && state !== "underway";
  return (
    <section class="card" aria-labelledby="measured-title">
      <div class="card-head">
        <h2 id="measured-title">{text.remeasured}</h2>
        {found && <Verdict {...found} />}
        <span class="spring" />
        {!sharedSlug && !refusal && (idle || error) && (
          <button onClick={() => void start()}>{found ? text.measureAgain : text.measure}</button>
        )}
      </div>
      {state === "never" && <p class="quiet small">{text.measureAbout}</p>}
      {state === "underway" && !error && (
        <p class="quiet" role="status">
          {note ? text.retrying(note) : text.measuring}
        </p>
      )}
      {error && <p class="banner wrong">{error}</p>}
      {found && <MeasurementResult {...found} />}
    </section>
  );
}

/** The measurement of a creature on this server, and a function that starts one. */
function useMeasurement(sha: string) {
  const [state, setState] = useState<State>("unknown");
  const [note, setNote] = useState<string | null>(null);
  const [error, setError] = useState<string | null>(null);
  const [turn, setTurn] = useState(0);
  useEffect(() => {
    const read = async () => {
      const found = await api.readMeasurement(sha);
      if (found === null) setState("underway");
      return found;
    };
    return poll(read, { value: setState, note: setNote, error: setError });
  }, [sha, turn]);
  const start = async () => {
    setError(null);
    setState("underway");
    try {
      await api.startMeasurement(sha);
      setTurn((count) => count + 1);
    } catch (reason) {
      setError(messageOf(reason));
    }
  };
  return { state, note, error, start };
}

function Verdict({ exact }: Measurement) {
  return (
    <span class={`badge ${exact ? "finished" : "paused"}`}>{exact ? text.identical : text.differs}</span>
  );
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
