/** A replay in a loop with its vorticity, and controls of its time. */

import { useMemo } from "preact/hooks";
import type { Replay } from "../decode/replay";
import { type Size, useTheme } from "../ui/canvas";
import { CanvasStage } from "./CanvasStage";
import { STEPS_PER_SECOND, useClock } from "./clock";
import { fieldOf } from "./fields";
import { FluidPainter } from "./fluid";
import { newPlayhead, usePlayhead } from "./playhead";
import { drawScene, sceneOf } from "./scene";
import { text } from "./text";
import { IconButton, StepRange } from "./timeControls";

export function LoopPlayer({ replay }: { replay: Replay }) {
  const theme = useTheme();
  const { frames, every, steps, size } = replay.header;
  const playhead = usePlayhead(useMemo(newPlayhead, []));
  const { time, playing } = playhead;
  useClock(playing, (seconds) => {
    playhead.move((playhead.time + (seconds * STEPS_PER_SECOND) / every) % Math.max(1, frames - 1));
  });
  const toggle = () => playhead.play(!playing);
  const scene = useMemo(() => {
    const painter = new FluidPainter(replay, fieldOf("vorticity", [replay], theme)!);
    return sceneOf(replay, { painter, follow: true, theme });
  }, [replay, theme]);
  const draw = (canvas: HTMLCanvasElement, shown: Size) => drawScene(canvas, shown, scene, time);
  return (
    <div class="player" role="group" aria-label={text.player}>
      <CanvasStage {...{ size, draw }} label={text.loop} inputs={[scene, time]} fits onClick={toggle} />
      <div class="row">
        <IconButton
          icon={playing ? "pause" : "play"}
          label={playing ? text.pause : text.play}
          onClick={toggle}
        />
        <StepRange {...{ time, every, steps }} last={frames - 1} onScrub={(at) => playhead.scrub(at)} />
      </div>
    </div>
  );
}
