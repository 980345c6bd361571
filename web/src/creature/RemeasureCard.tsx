/** Whether a creature does here what its file says: measured again when somebody asks. */

import { useEffect, useState } from "preact/hooks";
import * as api from "../api/client";
import { sharedSlug } from "../api/address";
import { messageOf } from "../api/problem";
import type { Measurement } from "../api/types";
import { useRefusal } from "../store/principal";
import { poll } from "../store/polling";
import { number, words } from "../ui/format";

type State = "unknown" | "never" | "underway" | Measurement;

export function RemeasureCard({ sha }: { sha: string }) {
  const { state, note, error, start } = useMeasurement(sha);
  const refusal = useRefusal();
  const found = typeof state === "string" ? null : state;
  if (sharedSlug && !found) return null; // Strangers have nothing measured.
  const idle = state !== "unknown" && state !== "underway";
  return (
    <section class="card" aria-labelledby="measured-title">
      <div class="card-head">
        <h2 id="measured-title">Measured here</h2>
        {found && <Verdict {...found} />}
        <span class="spring" />
        {!sharedSlug && !refusal && (idle || error) && (
          <button onClick={() => void start()}>{found ? "Measure once more" : "Measure it here"}</button>
        )}
      </div>
      {state === "never" && (
        <p class="quiet small">
          Runs the very program that measured it, and compares every recorded number bit for bit.
        </p>
      )}
      {state === "underway" && !error && (
        <p class="quiet" role="status">
          {note ? `${note} Trying again …` : "Measuring it; its program may have to be compiled first …"}
        </p>
      )}
      {error && <p class="banner wrong">{error}</p>}
      {found && <MeasurementResult {...found} />}
    </section>
  );
}

/** The measurement of a creature on this installation, and what starts one. */
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
  return <span class={`badge ${exact ? "finished" : "paused"}`}>{exact ? "identical" : "differs"}</span>;
}

function MeasurementResult({ exact, device, recorded_device, fitness, figures }: Measurement) {
  const same = device === recorded_device;
  return (
    <>
      <p class="small">
        {exact
          ? "Every recorded number came out the same, to the bit."
          : `Its fitness is ${number(fitness.measured, 6)} here; ${number(fitness.recorded, 6)} was recorded.`}{" "}
        {same
          ? "This is the kind of device that measured it first."
          : `Here it is ${device}; it was recorded on ${recorded_device}, where rounding may differ.`}
      </p>
      {figures.length > 0 && (
        <details>
          <summary>
            {figures.length === 1 ? "One number differs" : `${figures.length} numbers differ`}
          </summary>
          <table class="plain-table">
            <thead>
              <tr>
                <th scope="col">Number</th>
                <th scope="col">Recorded</th>
                <th scope="col">Here</th>
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
