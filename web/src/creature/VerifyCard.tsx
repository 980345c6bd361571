/** Evaluate a creature in this browser and compare with the numbers of its file. */

import type { Creature } from "../api/types";
import type { Evaluated } from "../simulate/evaluate";
import { isInstalled } from "../simulate/source";
import { count, number } from "../ui/format";
import { titleOf } from "../ui/measures";
import { type Column, Table } from "../ui/Table";
import { CheckCard } from "./CheckCard";
import { Agreement, Mark } from "./Mark";
import { text } from "./text";
import { useEffect, useState } from "preact/hooks";
import { messageOf } from "../api/problem";
import { decodeEvaluation } from "../decode/evaluation";
import { simulate } from "../simulate/simulator";
import { usePolled } from "../store/polling";

type Measured = NonNullable<Creature["measured"]>;

interface Props {
  measured: Measured;
  /** Read the inputs of the evaluation; null while they are prepared. */
  readInputs: () => Promise<ArrayBuffer | null>;
}

export function VerifyCard({ measured, readInputs }: Props) {
  const { found, uncovered, running, share, note, error, start } = useVerification(readInputs);
  const rows = found && compared(measured, found);
  const known = rows?.filter(({ here }) => here !== null);
  const again = found || uncovered || error !== null;
  return (
    <CheckCard
      {...{ note, error }}
      name="verify"
      title={text.verification}
      verdict={known && known.length > 0 && <Agreement same={known.every(isSame)} />}
      button={!isInstalled || running ? null : again ? text.verifyAgain : text.verify}
      onStart={start}
      running={running ? text.verifying(share) : null}
    >
      {!isInstalled && <p class="quiet small">{text.noSimulator}</p>}
      {isInstalled && !running && !again && <p class="quiet small">{text.verifyAbout}</p>}
      {uncovered && <p class="small">{text.notCovered(uncovered)}</p>}
      {found && rows && <Result {...{ found, rows, measured }} />}
    </CheckCard>
  );
}

/** Nine digits tell any two numbers of single precision apart. */
const digits = (row: Row) => (isSame(row) || row.here === null ? 6 : 9);

const COLUMNS: Column<Row>[] = [
  { title: text.number, cell: ({ name }) => titleOf(name) },
  {
    title: text.sameBits,
    unseen: true,
    cell: (row) =>
      row.here !== null && <Mark good={isSame(row)} word={isSame(row) ? text.sameBits : text.otherBits} />,
  },
  { title: text.recorded, cell: (row) => number(row.recorded, digits(row)) },
  { title: text.here, cell: (row) => (row.here === null ? text.ofWorker : number(row.here, digits(row))) },
];

function Result({ found, rows, measured }: { found: Evaluated; rows: Row[]; measured: Measured }) {
  const known = rows.filter(({ here }) => here !== null);
  const different = known.filter((row) => !isSame(row)).length;
  return (
    <>
      <p class="small">
        {known.length > 0 && text.verified(known.length, different)}{" "}
        {rows.length > known.length && text.workerLeft(rows.length - known.length)}{" "}
        {different > 0 && text.recordedOn(measured.device)}
      </p>
      <p class="quiet small">
        {text.took(
          count(found.steps),
          number(found.seconds, 3),
          count(Math.round(found.steps / found.seconds)),
        )}
      </p>
      <Table label={text.comparison} columns={COLUMNS} rows={rows} keyOf={({ name }) => name} />
    </>
  );
}

interface Row {
  name: string;
  recorded: number;
  /** Null for a measure that only a worker computes. */
  here: number | null;
}

/** The recorded numbers beside those found here, fitness first. */
function compared({ fitness, measures }: NonNullable<Creature["measured"]>, found: Evaluated): Row[] {
  return Object.entries({ fitness, ...measures }).map(([name, recorded]) => ({
    name,
    recorded,
    here: found.figures[name] ?? null,
  }));
}

/** True if the bits are the same. */
const isSame = ({ recorded, here }: Row) => Object.is(recorded, here);

interface State {
  /** The share of the simulations that are done. */
  share: number;
  found: Evaluated | null;
  /** The part of the creature that the simulator lacks. */
  uncovered: string | null;
  error: string | null;
}

const NOTHING: State = { share: 0, found: null, uncovered: null, error: null };

/** The state of the verification, and a function that starts it. */
function useVerification(readInputs: () => Promise<ArrayBuffer | null>) {
  const [starts, setStarts] = useState(0);
  const [state, setState] = useState(NOTHING);
  const asked = starts > 0;
  const polled = usePolled(asked ? readInputs : null, [starts]);
  useEffect(() => {
    setState(NOTHING);
    if (!polled.value) return;
    const stop = new AbortController();
    const change = (part: Partial<State>) => {
      if (!stop.signal.aborted) setState((old) => ({ ...old, ...part }));
    };
    verify(polled.value, change, stop.signal).catch((reason) => change({ error: messageOf(reason) }));
    return () => stop.abort();
  }, [polled.value]);
  const { found, uncovered } = state;
  const error = polled.error ?? state.error;
  const running = asked && !found && !uncovered && !error;
  return { ...state, error, note: polled.note, running, start: () => setStarts(starts + 1) };
}

async function verify(
  inputs: ArrayBuffer,
  change: (part: Partial<State>) => void,
  signal: AbortSignal,
): Promise<void> {
  const { uncovered } = decodeEvaluation(inputs);
  if (uncovered !== null) return change({ uncovered });
  change({ found: await simulate(inputs, (share) => change({ share }), signal) });
}
