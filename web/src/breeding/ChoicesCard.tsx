/** The chosen creatures of a run, and the generation from which each counts. */

import type { Choices, Run, Spec } from "../api/types";
import { type Group, groupsOf, takeBack } from "../store/choices";
import { usePoses } from "../store/poses";
import { useRefusal } from "../store/principal";
import { SwimmingBody } from "../replay/SwimmingBody";
import { count, number, percent, shortId } from "../ui/format";
import { Card } from "../ui/Page";
import { text } from "./text";
import "./breeding.css";

interface Props {
  run: Run;
  choices: Choices;
  /** Offspring of the chosen in the last generation. */
  children: number | null;
}

export function ChoicesCard({ run, choices, children }: Props) {
  const { batch, breeding } = run.spec.search as Spec & { batch: number; breeding: Spec };
  const { share, half_life } = breeding as { share: number; half_life: number };
  const poses = usePoses(null, choices.items);
  return (
    <Card id="chosen" title={text.chosen}>
      <p class="quiet small">
        {text.about(percent(share), number(half_life))}
        {children !== null && ` ${text.now(children, count(batch))}`}
      </p>
      <ol class="chosen">
        {groupsOf(choices).map((group) => (
          <Chosen key={group.generation} {...{ run, group, poses }} />
        ))}
      </ol>
    </Card>
  );
}

interface ChosenProps {
  run: Run;
  group: Group;
  poses: ReturnType<typeof usePoses>;
}

function Chosen({ run, group: { generation, creatures }, poses }: ChosenProps) {
  const refusal = useRefusal(run);
  return (
    <li>
      <h3>{generation === null ? text.next : text.from(count(generation))}</h3>
      <ul class="chosen-creatures">
        {creatures.map((sha) => (
          <li key={sha}>
            <a href={`/creatures/${sha}?run=${run.id}`} aria-label={text.creature(shortId(sha))}>
              <SwimmingBody stream={poses.get(sha) ?? null} />
              <code>{shortId(sha)}</code>
            </a>
          </li>
        ))}
      </ul>
      {generation === null && !refusal && (
        <button
          class="slim"
          aria-label={text.takeBackAll(creatures.length)}
          onClick={() => void takeBack(run.id, creatures)}
        >
          {text.takeBack}
        </button>
      )}
    </li>
  );
}
