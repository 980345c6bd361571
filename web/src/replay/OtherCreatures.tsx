/** Creatures to add: by name or address, or from the latest runs with a click. */

import { useState } from "preact/hooks";
import { readTankBatch, usePoses } from "../store/poses";
import { useTank } from "../store/tank";
import { number, shortId } from "../ui/format";
import { SwimmingBody } from "./SwimmingBody";
import { text } from "./text";
import "./others.css";

/** The most creatures shown. */
const SUGGESTED = 12;
const NAME = /[0-9a-f]{64}/;

type Pick = (creature: string) => void;

export function NamedCreature({ onPick }: { onPick: Pick }) {
  const [typed, setTyped] = useState("");
  const add = (event: Event) => {
    event.preventDefault();
    const found = NAME.exec(typed)?.[0];
    if (!found) return;
    onPick(found);
    setTyped("");
  };
  return (
    <form class="row named-creature" onSubmit={add}>
      <input
        aria-label={text.addCreature}
        placeholder={text.addCreatureHint}
        value={typed}
        onInput={(event) => setTyped(event.currentTarget.value)}
      />
      <button disabled={!NAME.test(typed)}>{text.add}</button>
    </form>
  );
}

/** Creatures of the latest runs, except some. */
export function LatestCreatures({ except, onPick }: { except: string[]; onPick: Pick }) {
  const tank = useTank(SUGGESTED + except.length).value;
  const others = (tank?.swimmers ?? []).filter(({ creature }) => !except.includes(creature));
  const poses = usePoses(readTankBatch, others);
  if (others.length === 0) return null;
  return (
    <section class="suggested" aria-label={text.suggested}>
      <p class="quiet small">{text.suggested}</p>
      {others.slice(0, SUGGESTED).map(({ creature, fitness }) => (
        <button
          key={creature}
          class="suggestion"
          aria-label={text.addNamed(shortId(creature), number(fitness))}
          title={text.addNamed(shortId(creature), number(fitness))}
          onClick={() => onPick(creature)}
        >
          <SwimmingBody stream={poses.get(creature) ?? null} onWater />
        </button>
      ))}
    </section>
  );
}
