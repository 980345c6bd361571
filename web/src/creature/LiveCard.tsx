/** Let a creature swim on in this browser, in water that visitors change. */

import { useState } from "preact/hooks";
import { messageOf } from "../api/problem";
import { isInstalled } from "../simulate/source";
import { usePolled } from "../store/polling";
import { CheckCard } from "./CheckCard";
import { type Others, LiveView } from "./live/LiveView";
import { text } from "./live/text";
import { useLive } from "./live/LiveStage";
import { text as cards } from "./text";

interface Props {
  /** Read the inputs of the evaluation; null while they are prepared. */
  readInputs: () => Promise<ArrayBuffer | null>;
  /** Other creatures that may join; missing where no other can be read. */
  others?: Others;
}

export function LiveCard({ readInputs, others }: Props) {
  const [on, setOn] = useState(false);
  const { value: inputs, note, error } = usePolled(on ? readInputs : null, [on]);
  const [failed, setFailed] = useState<string | null>(null);
  const fail = (reason: unknown) => {
    setFailed(messageOf(reason));
    setOn(false);
  };
  const live = useLive(inputs, fail);
  const start = () => {
    setFailed(null);
    setOn(!on);
  };
  if (!isInstalled) return null;
  return (
    <CheckCard
      {...{ note }}
      error={error ?? failed}
      name="live"
      title={text.title}
      verdict={null}
      button={on ? text.stop : text.start}
      onStart={start}
      running={on && !live ? cards.verifying(0) : null}
    >
      {!on && <p class="quiet small">{text.about}</p>}
      {live && <LiveView {...{ live }} others={others ?? null} onFail={fail} />}
    </CheckCard>
  );
}
