/** The page of a creature that was saved: motion, live water, verification and terms. Without one, the motion. */

import { LiveCard } from "../creature/LiveCard";
import { VerifyCard } from "../creature/VerifyCard";
import { swims } from "../creature/kinds";
import type { Creature } from "../api/types";
import type { Replay } from "../decode/replay";
import type { About } from "../offline/page";
import { LoopPlayer } from "../replay/LoopPlayer";
import { Facts } from "../ui/Facts";
import { number } from "../ui/format";
import { Card } from "../ui/Page";
import { text } from "./text";

interface Props {
  about: About;
  replay: Replay;
  /** Read the inputs of the evaluation. */
  readInputs: () => Promise<ArrayBuffer>;
}

export function SavedPage({ about, replay, readInputs }: Props) {
  const { title, creature, note } = about;
  if (!creature) {
    return (
      <div class="motion-alone">
        {/* The frame of a notebook is as high as the player, so it must not bound the stage. */}
        <LoopPlayer replay={replay} fits={false} />
        {note && <p class="quiet small">{note}</p>}
      </div>
    );
  }
  return (
    <main>
      <h1>{title}</h1>
      <Terms {...about} creature={creature} />
      <div class="saved-columns">
        <div class="stack">
          <section class="card" aria-label={text.motion}>
            <LoopPlayer replay={replay} />
          </section>
          <Card id="about" title={text.about}>
            <p class="small">{text.aboutText}</p>
            <p class="small">
              SHA-256 <code class="long">{creature.sha256}</code>
            </p>
          </Card>
        </div>
        <div class="stack">
          {swims(creature) && <LiveCard readInputs={readInputs} />}
          {creature.measured && <VerifyCard measured={creature.measured} readInputs={readInputs} />}
        </div>
      </div>
    </main>
  );
}

function Terms({ address, creature: { credit = [], licence, measured } }: About & { creature: Creature }) {
  return (
    <Facts
      kind="facts terms"
      of={[
        credit.length > 0 && [text.credit, credit.join(", ")],
        [text.licence, licence],
        measured && [text.fitness, number(measured.fitness, 4)],
        address !== null && [text.source, <a href={address}>{address}</a>],
      ]}
    />
  );
}
