/** The shape of the body over time: rest shape and actual shape. */

import type { Replay } from "../decode/replay";
import { setQuery } from "../store/router";
import { Segments } from "../ui/Select";
import type { Moment } from "../replay/moment";
import { type Measure, SpaceTime } from "./SpaceTime";
import { text } from "./text";

const TITLES: [Measure, string][] = [
  ["angles", text.angles],
  ["lengths", text.lengths],
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
        <h2 id="shape-title">{text.shape}</h2>
        <span class="spring" />
        <Segments
          label={text.shapeView}
          choices={TITLES}
          value={measure}
          onChoose={(name) => setQuery({ shape: name === "angles" ? null : name })}
        />
      </div>
      <SpaceTime {...{ replay, measure, moment }} />
    </section>
  );
}
