/** The run's history under one's finger: back to any generation, and played forward. */

import { useEffect, useState } from "preact/hooks";
import { count } from "../ui/format";
import { useClock } from "../replay/clock";
import { IconButton, TimeRange } from "../replay/Transport";

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
      <IconButton
        icon={playing ? "pause" : "play"}
        label={playing ? "Pause the history" : "Play the history"}
        title={playing ? "Pause" : "Play the history of the archive"}
        disabled={last === 0}
        onClick={playing ? () => setPlaying(false) : play}
      />
      <TimeRange
        label="Generation that the map shows"
        valueText={at === null ? `newest, ${shown}` : `${shown} of ${last}`}
        last={last}
        value={shown}
        disabled={last === 0}
        onScrub={scrub}
      />
      <output class="moment">{at !== null && !ready ? "Loading …" : `generation ${count(shown)}`}</output>
      <button class="small-button" disabled={at === null} onClick={() => scrub(last)}>
        Newest
      </button>
    </div>
  );
}
