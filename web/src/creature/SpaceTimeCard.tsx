/** The body's shape over time: what is asked of it, and what it does. */

import type { Replay } from "../decode/replay";
import { setQuery } from "../store/router";
import { Segments } from "../ui/Select";
import type { Moment } from "../replay/moment";
import { type Measure, SpaceTime } from "./SpaceTime";

const TITLES: [Measure, string][] = [
  ["angles", "Angles"],
  ["lengths", "Lengths"],
];

interface Props {
  replay: Replay;
  query: URLSearchParams;
  moment: Moment;
}

export function SpaceTimeCard({ replay, query, moment }: Props) {
  const measure: Measure = query.get("shape") === "lengths" ? "lengths" : "angles";
  return (
    <section class="card" aria-labelledby="shape-title">
      <div class="card-head">
        <h2 id="shape-title">Shape over time</h2>
        <span class="spring" />
        <Segments
          label="What is shown of the shape"
          choices={TITLES}
          value={measure}
          onChoose={(name) => setQuery({ shape: name === "angles" ? null : name })}
        />
      </div>
      <SpaceTime {...{ replay, measure, moment }} />
    </section>
  );
}
