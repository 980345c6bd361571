/** The shape of the body over time: rest shape and actual shape. */

import { useCallback, useMemo } from "preact/hooks";
import type { Replay } from "../decode/replay";
import { anglesOf, lengthsOf, colourLimit } from "../decode/shape";
import type { Playhead } from "../replay/clock";
import { setQuery } from "../store/router";
import { number, percent } from "../ui/format";
import { Card } from "../ui/Page";
import { Segments } from "../ui/Select";
import { DivergingLegend, HeatMap } from "./HeatMap";
import { text } from "./text";

const QUANTITIES = {
  angles: {
    ...{ shapeOf: anglesOf, item: "joint", unit: text.angleUnit },
    ...{ rest: text.restAngles, actual: text.bodyAngles },
    format: (value: number) => `${number(value)} rad`,
  },
  lengths: {
    ...{ shapeOf: lengthsOf, item: "edge", unit: text.lengthUnit },
    ...{ rest: text.restLengths, actual: text.bodyLengths },
    format: (value: number) => percent(value),
  },
};

type Quantity = keyof typeof QUANTITIES;

const TITLES: [Quantity, string][] = [
  ["angles", text.angles],
  ["lengths", text.lengths],
];

interface Props {
  replay: Replay;
  query: URLSearchParams;
  playhead: Playhead;
}

export function SpaceTimeCard({ replay, query, playhead }: Props) {
  const quantity = query.get("shape") === "lengths" ? "lengths" : "angles";
  const view = (
    <Segments
      label={text.shapeView}
      choices={TITLES}
      value={quantity}
      onSelect={(name) => setQuery({ shape: name === "angles" ? null : name })}
    />
  );
  return (
    <Card id="shape" title={text.shape} actions={view}>
      <SpaceTime {...{ replay, quantity, playhead }} />
    </Card>
  );
}

function SpaceTime({ replay, quantity, playhead }: Omit<Props, "query"> & { quantity: Quantity }) {
  const { shapeOf, item, unit, format, ...titles } = QUANTITIES[quantity];
  const shape = useMemo(() => shapeOf(replay), [replay, shapeOf]);
  const limit = useMemo(() => colourLimit(shape.rest, shape.actual), [shape]);
  const { frames, every, steps } = replay.header;
  const positionOf = useCallback((time: number) => (time + 0.5) / frames, [frames]);
  const timeAt = (share: number) => Math.min(frames - 1, Math.max(0, share * frames - 0.5));
  const { items } = shape.rest;
  const read = (column: number, row: number) => {
    const [rest, actual] = [shape.rest, shape.actual].map(({ values }) =>
      format(values[column * items + row]!),
    );
    return text.shapeAt(Math.min(steps, column * every), item, row + 1, rest!, actual!);
  };
  if (items === 0) return <p class="quiet">{text.hasNo(item)}</p>;
  return (
    <div class="space-time">
      {(["rest", "actual"] as const).map((part) => (
        <figure key={part}>
          <figcaption>{titles[part]}</figcaption>
          <div class="heat-frame">
            <span class="heat-up">
              <span>{items}</span>
              <span class="heat-name">{item}</span>
              <span>1</span>
            </span>
            <HeatMap
              matrix={{ columns: frames, rows: items, values: shape[part].values }}
              label={text.shapeMap(titles[part], steps, items, item)}
              {...{ limit, read, playhead, positionOf, timeAt }}
            />
          </div>
        </figure>
      ))}
      <p class="heat-across small quiet">
        <span>{text.step(0)}</span>
        <span>{text.step(steps)}</span>
      </p>
      <DivergingLegend title={unit} end={format(limit)} />
    </div>
  );
}
