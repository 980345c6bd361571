/** The run's history under one's finger: back to any generation, and played forward. */

import { useEffect, useState } from "preact/hooks";
import { count } from "../ui/format";
import { useClock } from "../replay/clock";

interface Props {
  /** The newest generation. */
  last: number;
  /** The generation that is shown; null: the newest, whichever that is. */
  at: number | null;
  /** Whether the past is known already. */
  ready: boolean;
  onMove: (generation: number | null) => void;
}

/** The whole history takes so long to play. */
const PLAY_SECONDS = 10;

export function TimeSlider({ last, at, ready, onMove }: Props) {
  const [playing, setPlaying] = useState(false);
  const [place, setPlace] = useState(0);
  const shown = at ?? last;
  useClock(playing && ready, (seconds) => {
    setPlace((now) => Math.min(last, now + (seconds * last) / PLAY_SECONDS));
  });
  useEffect(() => {
    if (!playing || !ready) return;
    const generation = Math.floor(place);
    if (place >= last) {
      setPlaying(false);
      onMove(null);
    } else if (generation !== at) onMove(generation);
  }, [place, playing, ready]);
  const play = () => {
    const begin = at === null ? 0 : at;
    setPlace(begin);
    onMove(begin);
    setPlaying(true);
  };
  const scrub = (generation: number) => {
    setPlaying(false);
    onMove(generation >= last ? null : generation);
  };
  return (
    <div class="time-slider">
      <button
        class="round"
        disabled={last === 0}
        onClick={playing ? () => setPlaying(false) : play}
        title={playing ? "Pause" : "Play the history of the archive"}
      >
        <span class="unseen">{playing ? "Pause the history" : "Play the history"}</span>
        <svg viewBox="0 0 16 16" aria-hidden="true">
          <path d={playing ? "M4 2.5h3v11H4zM9 2.5h3v11H9z" : "M4.5 2.5v11l9-5.5z"} />
        </svg>
      </button>
      <input
        type="range"
        class="scrub"
        aria-label="Generation that the map shows"
        aria-valuetext={at === null ? `newest, ${shown}` : `${shown} of ${last}`}
        min="0"
        max={last}
        value={shown}
        disabled={last === 0}
        onInput={(event) => scrub(event.currentTarget.valueAsNumber)}
      />
      <output class="moment">{at !== null && !ready ? "Loading …" : `generation ${count(shown)}`}</output>
      <button class="small-button" disabled={at === null} onClick={() => scrub(last)}>
        Newest
      </button>
    </div>
  );
}
