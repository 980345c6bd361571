/** The cases of a sweep as a legend, their final values, and every run. */

import type { Member, Spread } from "../api/types";
import { count, number, percent, words } from "../ui/format";
import { LineKey } from "../charts/lineStyle";
import { type ShownCase, memberName } from "./bands";
import { text } from "./text";

interface LegendProps {
  cases: ShownCase[];
  chosen: number[];
  onChoose: (places: number[]) => void;
}

/** One legend for all plots; a case that is not chosen is not drawn. */
export function Cases({ cases, chosen, onChoose }: LegendProps) {
  const turn = (place: number) =>
    onChoose(chosen.includes(place) ? chosen.filter((one) => one !== place) : [...chosen, place]);
  return (
    <ul class="compare-legend sweep-legend" aria-label={text.cases}>
      {cases.map(({ place, name }) => (
        <li key={place}>
          <label class="compact">
            <input type="checkbox" checked={chosen.includes(place)} onChange={() => turn(place)} />
            <LineKey index={place} />
            {name}
          </label>
        </li>
      ))}
    </ul>
  );
}

const TITLES: Record<string, [title: string, write: (value: number | null) => string]> = {
  qd_score: [text.qdScore, number],
  coverage: [text.coverage, percent],
  best: [text.bestFitness, number],
  evaluations: [text.evaluations, (value) => (value === null ? "–" : count(value))],
};

const titleOf = (name: string) => TITLES[name]?.[0] ?? words(name);
const writerOf = (name: string) => TITLES[name]?.[1] ?? number;

const figuresOf = (cases: ShownCase[]) => [
  ...new Set(cases.flatMap(({ summary }) => Object.keys(summary.finals))),
];

/** Figures at the common generation: the median of each case, and its quartiles. */
export function Finals({ cases, generation }: { cases: ShownCase[]; generation: number | null }) {
  const figures = figuresOf(cases);
  return (
    <section class="card" aria-labelledby="finals">
      <div class="card-head">
        <h2 id="finals">{text.figures}</h2>
        <span class="quiet small">{text.figuresAbout(generation)}</span>
      </div>
      <div class="wide-table" tabIndex={0} role="region" aria-label={text.figuresOfCases}>
        <table>
          <thead>
            <tr>
              <th scope="col">{text.case}</th>
              <th scope="col">{text.runs}</th>
              {figures.map((name) => (
                <th key={name} scope="col">
                  {titleOf(name)}
                </th>
              ))}
            </tr>
          </thead>
          <tbody>
            {cases.map(({ summary, place, name }) => (
              <tr key={place}>
                <th scope="row">
                  <LineKey index={place} /> {name}
                </th>
                <td>{doneOf(summary.members)}</td>
                {figures.map((figure) => (
                  <td key={figure}>
                    <Figure spread={summary.finals[figure]} write={writerOf(figure)} />
                  </td>
                ))}
              </tr>
            ))}
          </tbody>
        </table>
      </div>
    </section>
  );
}

/** How many of a case's runs are finished. */
function doneOf(members: ShownCase["summary"]["members"]): string {
  const done = members.filter(({ status }) => status === "finished").length;
  return done === members.length ? count(done) : text.finished(done, members.length);
}

interface SpreadProps {
  spread: Spread | undefined;
  write: (value: number | null) => string;
}

function Figure({ spread, write }: SpreadProps) {
  if (!spread || spread.median === null) return <>–</>;
  const { median, low, high, min, max } = spread;
  const one = min === max;
  return (
    <span title={`from ${write(min)} to ${write(max)}`}>
      <b>{write(median)}</b>
      {!one && <span class="quiet small spread">{text.range(write(low), write(high))}</span>}
    </span>
  );
}

/** Every run with its own figures. */
export function Members({ cases }: { cases: ShownCase[] }) {
  const figures = figuresOf(cases);
  const several = cases.length > 1;
  return (
    <section class="card" aria-labelledby="members">
      <h2 id="members">{text.runs}</h2>
      <div class="wide-table sweep-members" tabIndex={0} role="region" aria-label={text.everyRun}>
        <table>
          <thead>
            <tr>
              <th scope="col">{text.run}</th>
              {several && <th scope="col">{text.case}</th>}
              <th scope="col">{text.state}</th>
              <th scope="col">{text.generations}</th>
              {figures.map((name) => (
                <th key={name} scope="col">
                  {titleOf(name)}
                </th>
              ))}
            </tr>
          </thead>
          <tbody>
            {cases.flatMap((shown) =>
              shown.summary.members.map((member, i) => (
                <MemberRow key={member.run} {...{ shown, member, i, figures, several }} />
              )),
            )}
          </tbody>
        </table>
      </div>
    </section>
  );
}

interface MemberProps {
  shown: ShownCase;
  member: Member;
  /** The member's index within its case. */
  i: number;
  figures: string[];
  several: boolean;
}

function MemberRow({ shown: { summary, place, name }, member, i, figures, several }: MemberProps) {
  return (
    <tr>
      <th scope="row">
        <a href={`/runs/${member.run}`}>{memberName(member)}</a>
      </th>
      {several && (
        <td>
          <LineKey index={place} /> {name}
        </td>
      )}
      <td>
        <span class={`badge ${member.status}`}>{member.status}</span>
      </td>
      <td>
        {count(member.generation)} / {count(member.generations)}
      </td>
      {figures.map((figure) => (
        <td key={figure}>{writerOf(figure)(summary.finals[figure]?.values[i] ?? null)}</td>
      ))}
    </tr>
  );
}
