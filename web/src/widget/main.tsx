/** The module that anywidget loads: a map or a player, by the kind of the model. */

import { render as draw } from "preact";
import "../ui/base.css";
import "../ui/parts.css";
import "../archive/map.css";
import "../archive/archive.css";
import "../replay/replay.css";
import "./widget.css";
import { MapWidget } from "./MapWidget";
import { type Model, useField } from "./model";
import { useTheme } from "../ui/canvas";
import { useMemo } from "preact/hooks";
import { decodeReplay } from "../decode/replay";
import { LoopPlayer } from "../replay/LoopPlayer";
import { SwimmingBody } from "../replay/SwimmingBody";
import { useKept, usePoseStream } from "./poses";
import { text } from "./text";

function Widget({ model }: { model: Model }) {
  const Shown = model.get("_kind") === "map" ? MapWidget : PlayerWidget;
  return (
    <div class="widget" style={{ colorScheme: useTheme() }}>
      <Shown model={model} />
    </div>
  );
}

/** Called for each view of a model; the result removes the view. */
function render({ model, el }: { model: Model; el: HTMLElement }): () => void {
  el.classList.add("microcosmos");
  draw(<Widget model={model} />, el);
  return () => draw(null, el);
}

export default { render };

function PlayerWidget({ model }: { model: Model }) {
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
