/** The module that anywidget loads: a map or a player, by the kind of the model. */

import { render as draw } from "preact";
import "../ui/base.css";
import "../ui/parts.css";
import "../archive/map.css";
import "../archive/archive.css";
import "../replay/replay.css";
import "./widget.css";
import { MapWidget } from "./MapWidget";
import type { Model } from "./model";
import { PlayerWidget } from "./PlayerWidget";
import { useTheme } from "../ui/canvas";

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
