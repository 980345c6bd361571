/** The page of a creature that was saved: motion, live water, verification and terms. */

import { LiveCard } from "../creature/LiveCard";
import { VerifyCard } from "../creature/VerifyCard";
import { swims } from "../creature/kinds";
import type { Replay } from "../decode/replay";
import type { About } from "../offline/page";
import { LoopPlayer } from "../replay/LoopPlayer";
import { number } from "../ui/format";
import { Card } from "../ui/Page";
import { text } from "./text";

interface Props {
  about: About;
  replay: Replay;
  /** Read the inputs of the evaluation anew: a worker takes them over. */
  readInputs: () => Promise<ArrayBuffer>;
}

export function SavedPage({ about, replay, readInputs }: Props) {
  const { title, creature } = about;
  return (
    <main>
      <h1>{title}</h1>
      <Terms {...about} />
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

function Terms({ address, creature: { credit = [], licence, measured } }: About) {
  const facts: [string, preact.ComponentChildren][] = [
    ...(credit.length > 0 ? [[text.credit, credit.join(", ")] as [string, string]] : []),
    [text.licence, licence],
    ...(measured ? [[text.fitness, number(measured.fitness, 4)] as [string, string]] : []),
    ...(address
      ? [[text.source, <a href={address}>{address}</a>] as [string, preact.ComponentChildren]]
      : []),
  ];
  return (
    <dl class="facts terms">
      {facts.map(([name, value]) => (
        <div key={name}>
          <dt>{name}</dt>
          <dd>{value}</dd>
        </div>
      ))}
    </dl>
  );
}
