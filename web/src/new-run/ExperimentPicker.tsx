/** The choice of an experiment and a preset. */

import { useState } from "preact/hooks";
import type { Estimate, Experiment, Preset } from "../api/types";
import { timeText } from "./Costs";
import { bytes, words } from "../ui/format";
import { text } from "./text";

interface Props {
  experiments: Experiment[];
  selected: Experiment;
  preset: Preset | null;
  estimates: ReadonlyMap<Preset, Estimate>;
  onExperiment: (experiment: Experiment) => void;
  onPreset: (preset: Preset, experiment: Experiment) => void;
}

export function ExperimentPicker({
  experiments,
  selected,
  preset,
  estimates,
  onExperiment,
  onPreset,
}: Props) {
  return (
    <>
      <fieldset class="experiments">
        <legend class="unseen">{text.experiment}</legend>
        {experiments.map((one) => (
          <label key={one.experiment} class="experiment" title={words(one.about)}>
            <input
              type="radio"
              name="experiment"
              checked={one === selected}
              onChange={() => onExperiment(one)}
            />
            <b>{one.title}</b>
            <span class={one === selected ? "" : "unseen"}>{words(one.about)}</span>
          </label>
        ))}
      </fieldset>
      <Presets {...{ selected, preset, estimates, onPreset }} />
    </>
  );
}

type PresetsProps = Pick<Props, "selected" | "preset" | "estimates" | "onPreset">;

/** The presets of an experiment; below them what the pointed one is, or else the chosen one. */
function Presets({ selected, preset, estimates, onPreset }: PresetsProps) {
  const [pointed, setPointed] = useState<Preset | null>(null);
  const shown = pointed ?? preset;
  return (
    <>
      <fieldset class="presets">
        <legend class="unseen">{selected.title}</legend>
        {selected.presets.map((each) => (
          <button
            type="button"
            key={each.name}
            class="preset"
            title={each.title}
            aria-pressed={each === preset}
            onClick={() => onPreset(each, selected)}
            onPointerEnter={() => setPointed(each)}
            onPointerLeave={() => setPointed(null)}
            onFocus={() => setPointed(each)}
            onBlur={() => setPointed(null)}
          >
            <b>{words(each.name)}</b>
            <span class="unseen">{each.title}</span>
            <span class="preset-cost">{costOf(estimates.get(each))}</span>
          </button>
        ))}
        {selected.presets.length === 0 && <p class="quiet needs-creature">{text.needsCreature}</p>}
      </fieldset>
      <p class="quiet small preset-about">{shown && `${shown.title}.`}</p>
    </>
  );
}

function costOf(estimate: Estimate | undefined): string {
  if (!estimate) return " ";
  return `${timeText(estimate) ?? text.timeUnknown} · ${bytes(estimate.memory_bytes)}`;
}
