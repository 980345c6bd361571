/** Options of curves, in the address. */

import type { ComponentChildren } from "preact";
import { setQuery } from "../../store/router";
import { Check, Select } from "../../ui/Select";
import { AXES, type CurveView, WINDOWS } from "./curveView";
import { text } from "./text";
import "./curves.css";

const MEANS = WINDOWS.map((size): [string, string] => [
  String(size),
  size === 1 ? text.none : text.window(size),
]);

export function CurveOptions({ view: { over, smooth, log } }: { view: CurveView }) {
  return (
    <CurveBar log={log}>
      <Select
        title={text.axis}
        choices={AXES.map((name) => [name, text.over[name]])}
        value={over}
        onChange={(name) => setQuery({ over: name === "generation" ? null : name })}
      />
      <Select
        title={text.smooth}
        choices={MEANS}
        value={String(smooth)}
        onChange={(size) => setQuery({ smooth: size === "1" ? null : size })}
      />
    </CurveBar>
  );
}

/** A bar of options, which ends with the scale. */
export function CurveBar({ log, children }: { log: boolean; children: ComponentChildren }) {
  return (
    <div class="row curve-choices" role="group" aria-label={text.options}>
      {children}
      <QueryCheck title={text.logScale} name="log" on={log} />
    </div>
  );
}

/** A checkbox for a parameter of the address. */
export function QueryCheck({ title, name, on }: { title: string; name: string; on: boolean }) {
  return <Check title={title} on={on} onChange={(checked) => setQuery({ [name]: checked ? "1" : null })} />;
}
