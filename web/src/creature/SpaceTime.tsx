/** Rest shapes as asked for, and what the body made of them, over time and along the body. */

import { useCallback, useMemo } from "preact/hooks";
import { type Shape, anglesOf, lengthsOf, sizeOf } from "../decode/shape";
import type { Replay } from "../decode/replay";
import { ColourBar } from "../ui/ColourBar";
import { css, diverging } from "../ui/colours";
import { number, percent } from "../ui/format";
import type { Moment } from "../replay/moment";
import { useTheme } from "../ui/theme";
import { HeatMap } from "./HeatMap";
import { text } from "./text";

export type Measure = "angles" | "lengths";

interface Kind {
  of: (replay: Replay) => Shape;
  item: string;
  asked: string;
  done: string;
  unit: string;
  write: (value: number) => string;
}

const KINDS: Record<Measure, Kind> = {
  angles: {
    of: anglesOf,
    item: "joint",
    asked: text.restAngles,
    done: text.bodyAngles,
    unit: text.angleUnit,
    write: (value) => `${number(value)} rad`,
  },
  lengths: {
    of: lengthsOf,
    item: "edge",
    asked: text.restLengths,
    done: text.bodyLengths,
    unit: text.lengthUnit,
    write: (value) => percent(value),
  },
};

interface Props {
  replay: Replay;
  measure: Measure;
  moment: Moment;
}

export function SpaceTime({ replay, measure, moment }: Props) {
  const kind = KINDS[measure];
  const shape = useMemo(() => kind.of(replay), [replay, kind]);
  const most = useMemo(() => sizeOf(shape.asked, shape.done), [shape]);
  const { frames, every, steps } = replay.header;
  const place = useCallback((time: number) => (time + 0.5) / frames, [frames]);
  const timeAt = (share: number) => Math.min(frames - 1, Math.max(0, share * frames - 0.5));
  const { items } = shape.asked;
  const read = (column: number, row: number) => {
    const value = (course: Shape["asked"]) => kind.write(course.values[column * items + row]!);
    const step = Math.min(steps, column * every);
    return text.shapeAt(step, kind.item, row + 1, value(shape.asked), value(shape.done));
  };
  if (items === 0) return <p class="quiet">{text.hasNo(kind.item)}</p>;
  return (
    <div class="space-time">
      {(["asked", "done"] as const).map((part) => (
        <figure key={part}>
          <figcaption>{kind[part]}</figcaption>
          <div class="heat-frame">
            <span class="heat-up">
              <span>{items}</span>
              <span class="heat-name">{kind.item}</span>
              <span>1</span>
            </span>
            <HeatMap
              cells={{ columns: frames, rows: items, values: shape[part].values }}
              label={text.shapeMap(kind[part], steps, items, kind.item)}
              {...{ most, read, moment, place, timeAt }}
            />
          </div>
        </figure>
      ))}
      <p class="heat-across small quiet">
        <span>{text.step(0)}</span>
        <span>{text.step(steps)}</span>
      </p>
      <DivergingLegend title={kind.unit} end={kind.write(most)} />
    </div>
  );
}

export function DivergingLegend({ title, end }: { title: string; end: string }) {
  const theme = useTheme();
  return (
    <ColourBar
      name={title}
      label={`${title}: from −${end} to ${end}`}
      colourAt={(share) => css(diverging(2 * share - 1, theme))}
      numbers={[`−${end}`, "0", end]}
    />
  );
}
