/** Evaluate a creature in this browser and compare with the numbers of its file. */

import type { Creature } from "../api/types";
import type { Evaluated } from "../simulate/evaluate";
import { isInstalled } from "../simulate/source";
import { count, number, words } from "../ui/format";
import { type Column, Table } from "../ui/Table";
import { CheckCard } from "./CheckCard";
import { Mark } from "./Mark";
import { text } from "./text";
import { type Row, compared, isSame, useVerification } from "./verification";

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
      verdict={known && <Verdict same={known.every(isSame)} />}
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

function Verdict({ same }: { same: boolean }) {
  return <span class={`badge ${same ? "finished" : "paused"}`}>{same ? text.identical : text.differs}</span>;
}

/** Nine digits tell any two numbers of single precision apart. */
const digits = (row: Row) => (isSame(row) || row.here === null ? 6 : 9);

const COLUMNS: Column<Row>[] = [
  { title: text.number, cell: ({ name }) => text.measures[name]?.[0] ?? words(name) },
  {
    title: text.sameBits,
    unseen: true,
    cell: (row) =>
      row.here !== null && <Mark good={isSame(row)} word={isSame(row) ? text.sameBits : text.otherBits} />,
  },
  { title: text.recorded, cell: (row) => number(row.recorded, digits(row)) },
  { title: text.here, cell: (row) => (row.here === null ? text.ofPlugin : number(row.here, digits(row))) },
];

function Result({ found, rows, measured }: { found: Evaluated; rows: Row[]; measured: Measured }) {
  const known = rows.filter(({ here }) => here !== null);
  const different = known.filter((row) => !isSame(row)).length;
  return (
    <>
      <p class="small">
        {text.verified(known.length, different)}{" "}
        {rows.length > known.length && text.pluginsLeft(rows.length - known.length)}{" "}
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
