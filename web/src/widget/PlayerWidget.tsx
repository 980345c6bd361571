/** A creature that swims in a notebook: a replay with its fluid, or the strokes of a pose stream. */

import { useMemo } from "preact/hooks";
import { decodeReplay } from "../decode/replay";
import { LoopPlayer } from "../replay/LoopPlayer";
import { SwimmingBody } from "../replay/SwimmingBody";
import { type Model, useField } from "./model";
import { useKept, usePoseStream } from "./poses";
import { text } from "./text";

export function PlayerWidget({ model }: { model: Model }) {
  const [replay] = useField(model, "_replay");
  const [poses] = useField(model, "_poses");
  const [creature] = useField(model, "_creature");
  const [about] = useField(model, "_about");
  useKept(poses);
  const { stream } = usePoseStream(creature);
  const film = useMemo(() => replayOf(replay), [replay]);
  return (
    <>
      {film ? (
        <LoopPlayer replay={film} />
      ) : (
        <div class="strokes">{stream && <SwimmingBody stream={stream} label={text.strokes} path />}</div>
      )}
      <p class="quiet small about">{about}</p>
    </>
  );
}

const replayOf = ({ buffer, byteOffset, byteLength }: DataView) =>
  byteLength > 0 ? decodeReplay((buffer as ArrayBuffer).slice(byteOffset, byteOffset + byteLength)) : null;
