/** A creature that swims beside the cell that holds it. */

import type { Replay } from "../decode/replay";
import { ReplayLoop } from "./Loop";
import { text } from "./text";
import "./replay.css";

interface Props {
  replay: Replay | null;
  /** What is being waited for, or what went wrong. */
  note: string;
}

export function ReplayInset({ replay, note }: Props) {
  return (
    <div class="inset" data-inset>
      {replay ? (
        <ReplayLoop
          key={replay.header.creature}
          replay={replay}
          name={text.inset}
          onFirst={() => mark("inset")}
        />
      ) : (
        <p>{note}</p>
      )}
    </div>
  );
}

/** For whoever measures how long one waits for it: the newest alone. */
function mark(name: string): void {
  performance.clearMarks(name);
  performance.mark(name);
}
