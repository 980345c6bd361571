/** The cases of a sweep: a legend, their figures, every run, and the best creature of each. */

import type { Member, Spread } from "../api/types";
import { DASH, count, number, words } from "../ui/format";
import { LineSample } from "../charts/lineStyle";
import { CORRECTED, SCORES } from "../run/figures";
import { Card } from "../ui/Page";
import { type Column, Table } from "../ui/Table";
import { type ShownCase, memberName } from "./summaryPlots";
import { text } from "./text";
import { SwimmingBody } from "../replay/SwimmingBody";
import { readTankBatch, usePoses } from "../store/poses";
import { SideBySide } from "../ui/links";

interface LegendProps {
  cases: ShownCase[];
  selected: number[];
  onSelect: (places: number[]) => void;
}

/** One legend for all plots, which draw only the selected cases. */
export function Cases({ cases, selected, onSelect }: LegendProps) {
  const toggle = (caseIndex: number) =>
    onSelect(
      selected.includes(caseIndex) ? selected.filter((one) => one !== caseIndex) : [...selected, caseIndex],
    );
  return (
    <ul class="compare-legend sweep-legend" aria-label={text.cases}>
      {cases.map((shown) => (
        <li key={shown.caseIndex}>
          <label class="compact">
            <input
              type="checkbox"
              checked={selected.includes(shown.caseIndex)}
              onChange={() => toggle(shown.caseIndex)}
            />
            <CaseName shown={shown} />
          </label>
        </li>
      ))}
    </ul>
  );
}

function CaseName({ shown: { caseIndex, name } }: { shown: ShownCase }) {
  return (
    <>
      <LineSample index={caseIndex} /> {name}
    </>
  );
}

type Format = (value: number | null) => string;

const KNOWN_FIGURES: [name: string, title: string, format: Format][] = [
  ...SCORES,
  ...CORRECTED,
  ["evaluations", text.evaluations, count],
];

function figuresOf(cases: ShownCase[]) {
  const names = new Set(cases.flatMap(({ summary }) => Object.keys(summary.finals)));
  return [...names].map((name) => {
    const [, title, format] = KNOWN_FIGURES.find(([known]) => known === name) ?? [name, words(name), number];
    return { name, title, format };
  });
}

/** Figures at the common generation: the median of each case, and its quartiles. */
export function Finals({ cases, generation }: { cases: ShownCase[]; generation: number | null }) {
  const columns: Column<ShownCase>[] = [
    { title: text.case, cell: (shown) => <CaseName shown={shown} /> },
    { title: text.runs, cell: ({ summary }) => doneOf(summary.members) },
    ...figuresOf(cases).map(({ name, title, format }) => ({
      title,
      cell: ({ summary }: ShownCase) => <Figure spread={summary.finals[name]} format={format} />,
    })),
  ];
  return (
    <Card id="finals" title={text.figures} note={text.figuresAbout(generation)}>
      <Table
        label={text.figuresOfCases}
        columns={columns}
        rows={cases}
        keyOf={({ caseIndex }) => caseIndex}
      />
    </Card>
  );
}

function doneOf(members: Member[]): string {
  const done = members.filter(({ status }) => status === "finished").length;
  return done === members.length ? count(done) : text.finished(done, members.length);
}

function Figure({ spread, format }: { spread: Spread | undefined; format: Format }) {
  if (!spread || spread.median === null) return <>{DASH}</>;
  const { median, low, high, min, max } = spread;
  return (
    <span title={text.extremes(format(min), format(max))}>
      <b>{format(median)}</b>
      {min !== max && <span class="quiet small spread">{text.range(format(low), format(high))}</span>}
    </span>
  );
}

interface Row {
  shown: ShownCase;
  member: Member;
  i: number;
}

export function Members({ cases }: { cases: ShownCase[] }) {
  const rows = cases.flatMap((shown) =>
    shown.summary.members.map((member, i): Row => ({ shown, member, i })),
  );
  const caseColumn: Column<Row> = { title: text.case, cell: ({ shown }) => <CaseName shown={shown} /> };
  const columns: Column<Row>[] = [
    { title: text.run, cell: ({ member }) => <a href={`/runs/${member.run}`}>{memberName(member)}</a> },
    ...(cases.length > 1 ? [caseColumn] : []),
    {
      title: text.state,
      cell: ({ member: { status } }) => <span class={`badge ${status}`}>{status}</span>,
    },
    {
      title: text.generations,
      cell: ({ member }) => `${count(member.generation)} / ${count(member.generations)}`,
    },
    ...figuresOf(cases).map(({ name, title, format }) => ({
      title,
      cell: ({ shown, i }: Row) => format(shown.summary.finals[name]?.values[i] ?? null),
    })),
  ];
  return (
    <Card id="members" title={text.runs}>
      <Table
        label={text.everyRun}
        kind="sweep-members"
        columns={columns}
        rows={rows}
        keyOf={({ member }) => member.run}
      />
    </Card>
  );
}

type Found = Member & { face: string; best: number };

const foundOf = ({ summary }: ShownCase): Found[] =>
  summary.members.filter((member): member is Found => member.face !== null && member.best !== null);

export function CaseCreatures({ shown }: { shown: ShownCase[] }) {
  const rows = shown.map((one) => ({ one, found: foundOf(one) })).filter(({ found }) => found.length > 0);
  const visible = rows.flatMap(({ found }) => found.map(({ face }) => ({ creature: face })));
  const poses = usePoses(readTankBatch, visible, false);
  if (rows.length === 0) return null;
  const best = [...new Set(rows.map(({ found }) => fittest(found).face))];
  return (
    <Card
      id="creatures"
      title={text.creatures}
      note={text.creaturesAbout}
      actions={<SideBySide creatures={best} title={text.sideBySide} />}
    >
      <ul class="case-creatures">
        {rows.map(({ one, found }) => (
          <li key={one.caseIndex}>
            <span>
              <CaseName shown={one} />
            </span>
            <ul>
              {found.map((member) => (
                <li key={member.run}>
                  <a
                    href={`/creatures/${member.face}?run=${member.run}`}
                    title={text.bestOf(memberName(member))}
                  >
                    <SwimmingBody stream={poses.get(member.face) ?? null} onWater />
                    <span class="small">{number(member.best)}</span>
                  </a>
                </li>
              ))}
            </ul>
          </li>
        ))}
      </ul>
    </Card>
  );
}

const fittest = (found: Found[]) => found.reduce((best, one) => (one.best > best.best ? one : best));
