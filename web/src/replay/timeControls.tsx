/** Buttons and sliders that move through time: the frames of a replay, or the generations of a run. */

import { text } from "./text";
import { useEffect, useState } from "preact/hooks";
import { count } from "../ui/format";
import { useClock } from "./clock";
import "./replay.css";

const PATHS = {
  play: "M4.5 2.5v11l9-5.5z",
  pause: "M4 2.5h3v11H4zM9 2.5h3v11H9z",
  back: "M11 3v10L4.5 8zM3 3h1.8v10H3z",
  forward: "M5 3v10l6.5-5zM11.2 3H13v10h-1.8z",
};

interface ButtonProps {
  icon: keyof typeof PATHS;
  label: string;
  title?: string;
  /** Keyboard shortcuts, in the form of `aria-keyshortcuts`. */
  keys?: string;
  disabled?: boolean;
  onClick: () => void;
}

const KEY_NAMES: Record<string, string> = { Space: "space bar", ArrowLeft: "←", ArrowRight: "→" };

export function IconButton({ icon, label, title, keys, disabled, onClick }: ButtonProps) {
  const named = keys?.split(" ").map((key) => KEY_NAMES[key] ?? key);
  const small = icon === "back" || icon === "forward";
  return (
    <button
      class={`round ${small ? "small-round" : ""}`}
      {...{ disabled, onClick }}
      aria-keyshortcuts={keys}
      title={title ?? (named ? `${label} (${named.join(" or ")})` : label)}
    >
      <span class="unseen">{label}</span>
      <svg viewBox="0 0 16 16" aria-hidden="true">
        <path d={PATHS[icon]} />
      </svg>
    </button>
  );
}

interface SliderProps {
  label: string;
  value: number;
  last: number;
  /** Smallest movement; `any` if time is continuous. */
  step?: "any" | 1;
  /** The value for screen readers. */
  valueText: string;
  keys?: string;
  title?: string;
  disabled?: boolean;
  onScrub: (value: number) => void;
}

function TimeRange({ label, last, valueText, keys, onScrub, ...rest }: SliderProps) {
  return (
    <input
      type="range"
      class="scrub"
      aria-label={label}
      aria-keyshortcuts={keys}
      aria-valuetext={valueText}
      min="0"
      max={last}
      {...rest}
      onInput={(event) => onScrub(event.currentTarget.valueAsNumber)}
    />
  );
}

interface StepProps extends Pick<SliderProps, "last" | "onScrub" | "keys" | "title"> {
  /** In frames of `every` steps. */
  time: number;
  every: number;
  steps: number;
}

/** A slider over the frames of a replay, with the step number. */
export function StepRange({ time, every, steps, ...rest }: StepProps) {
  const step = Math.min(steps, Math.round(time * every));
  const valueText = text.step(step, steps);
  return (
    <>
      <TimeRange label={text.moment} step="any" value={time} {...{ valueText }} {...rest} />
      <output class="moment quiet small">
        {step} / {steps}
      </output>
    </>
  );
}

interface Props {
  /** The newest generation. */
  last: number;
  /** The generation shown; null for the newest. */
  at: number | null;
  /** True if the history is loaded. */
  ready: boolean;
  onMove: (generation: number | null) => void;
}

/** Duration of the playback. */
const PLAY_SECONDS = 10;

export function TimeSlider({ last, at, ready, onMove }: Props) {
  const [playing, setPlaying] = useState(false);
  const [position, setPosition] = useState(0);
  const shown = at ?? last;
  useClock(playing && ready, (seconds) => {
    setPosition((now) => Math.min(last, now + (seconds * last) / PLAY_SECONDS));
  });
  useEffect(() => {
    if (!playing || !ready) return;
    const generation = Math.floor(position);
    if (position >= last) {
      setPlaying(false);
      onMove(null);
    } else if (generation !== at) onMove(generation);
  }, [position, playing, ready]);
  const play = () => {
    setPosition(at ?? 0);
    onMove(at ?? 0);
    setPlaying(true);
  };
  const scrub = (generation: number) => {
    setPlaying(false);
    onMove(generation >= last ? null : generation);
  };
  return (
    <div class="time-slider">
      <IconButton
        icon={playing ? "pause" : "play"}
        label={playing ? text.history.pause : text.history.play}
        disabled={last === 0}
        onClick={playing ? () => setPlaying(false) : play}
      />
      <TimeRange
        label={text.history.shown}
        valueText={at === null ? text.history.newestOf(shown) : text.history.generationOf(shown, last)}
        last={last}
        value={shown}
        disabled={last === 0}
        onScrub={scrub}
      />
      <output class="moment quiet small">
        {!ready ? text.history.loading : text.history.moment(count(shown))}
      </output>
      <button class="small-button" disabled={at === null} onClick={() => scrub(last)}>
        {text.history.newest}
      </button>
    </div>
  );
}
