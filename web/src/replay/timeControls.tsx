/** Buttons and sliders that move through time. */

import { text } from "./text";

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

export function TimeRange({ label, last, valueText, keys, onScrub, ...rest }: SliderProps) {
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
