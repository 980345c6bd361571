/** A slider through the generations of a run, with playback. */

import { useEffect, useState } from "preact/hooks";
import { count } from "../ui/format";
import { useClock } from "./clock";
import { IconButton, TimeRange } from "./timeControls";
import { text } from "./text";
import "./replay.css";

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
