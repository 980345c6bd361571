/** One line over the tank: what evolves, and how far it is. */

import type { Run, Tank } from "../api/types";
import { useStore } from "../store/store";
import { duration, labelOf, number } from "../ui/format";
import { timeOf } from "../run/RunStatus";
import { text } from "./text";

export function TankLine({ tank }: { tank: Tank }) {
  const runs = useStore((state) => state.runs);
  const running = [...runs.values()].filter(({ status }) => status === "running");
  const first = running.sort((a, b) => b.created_at.localeCompare(a.created_at))[0];
  if (!first && tank.swimmers.length === 0) return null;
  return (
    <p class="tank-line">
      {first ? (
        <Evolving run={first} others={running.length - 1} />
      ) : (
        text.still(tank.swimmers.length, new Set(tank.swimmers.map(({ run }) => run)).size)
      )}
    </p>
  );
}

function Evolving({ run, others }: { run: Run; others: number }) {
  const { generation, generations, evaluations_per_second: rate } = run;
  const facts = [text.progress(generation, generations)];
  if (rate) facts.push(text.rate(number(rate)));
  if (run.eta_seconds !== null && timeOf(run).text !== "–") facts.push(text.left(duration(run.eta_seconds)));
  if (others > 0) facts.push(text.more(others));
  return (
    <>
      <span class="ripple small-ripple" aria-hidden="true" />
      <span>
        <a href={`/runs/${run.id}`}>{labelOf(run)}</a> {text.evolves}
      </span>
      <span class="tank-facts">{facts.join(" · ")}</span>
    </>
  );
}
