/** How curves are drawn, as the address holds it. */

import { setQuery } from "../router";
import { Choice } from "../view/Choice";
import { AXES, type Look, OVER, WINDOWS } from "../view/curves/look";

const MEANS = WINDOWS.map((size): [string, string] => [
  String(size),
  size === 1 ? "none" : `mean of ${size} generations`,
]);

export function CurveChoices({ look: { over, smooth, log } }: { look: Look }) {
  return (
    <div class="curve-choices" role="group" aria-label="How curves are drawn">
      <Choice
        title="Over"
        choices={AXES.map((name) => [name, OVER[name]])}
        value={over}
        onChange={(name) => setQuery({ over: name === "generation" ? null : name })}
      />
      <Choice
        title="Smooth"
        choices={MEANS}
        value={String(smooth)}
        onChange={(size) => setQuery({ smooth: size === "1" ? null : size })}
      />
      <label class="compact">
        <input
          type="checkbox"
          checked={log}
          onChange={(event) => setQuery({ log: event.currentTarget.checked ? "1" : null })}
        />
        Log scale
      </label>
    </div>
  );
}
