/** The creature of a tree that is pointed at or selected, swimming, with its facts. */

import type { ComponentChildren } from "preact";
import { type Phylogeny, NONE, nameAt, parentsOf } from "../decode/phylogeny";
import { SwimmingBody } from "../replay/SwimmingBody";
import { usePoseStream } from "../store/poses";
import { useThrottled } from "../store/polling";
import { count, number, shortId } from "../ui/format";
import type { TreeLayout } from "./layout";
import { text } from "./text";

interface Props {
  tree: Phylogeny;
  layout: TreeLayout;
  creature: number;
  /** The side of the window on which it is shown. */
  side: "left" | "right";
  /** The page of a creature; null if a share lacks it. */
  hrefOf: (creature: number) => string | null;
}

/** Delay between requests while the pointer moves. */
const HOVER_MS = 150;

export function TreeCreature({ creature, side, ...props }: Props) {
  const card = creature === NONE ? "" : `tree-card ${side}`;
  return (
    <section id="tree-creature" class={card} aria-live="polite" aria-label={text.creature}>
      {creature !== NONE && <Facts creature={creature} {...props} />}
    </section>
  );
}

function Facts({ tree, layout, creature, hrefOf }: Omit<Props, "side">) {
  const sha = nameAt(tree, creature);
  const shown = useThrottled(sha, HOVER_MS);
  const page = hrefOf(creature);
  const { stream } = usePoseStream(page === null || shown !== sha ? null : shown);
  const [run, generation, lost] = [tree.run[creature]!, tree.generation[creature]!, tree.lost[creature]!];
  const operator = tree.operators[tree.operator[creature]!];
  const parents = parentsOf(tree, creature);
  const status = run === NONE ? null : lost === NONE ? text.elite : text.lost(count(lost));
  return (
    <>
      {page !== null && (
        <div class="tree-body">{stream && <SwimmingBody key={sha} stream={stream} path />}</div>
      )}
      <div class="tree-facts small">
        <Linked page={page}>
          {page !== null && `${text.open} `}
          <code>{shortId(sha)}</code>
        </Linked>
        <span>
          {text.fitness} <b>{number(tree.fitness[creature]!)}</b>
        </span>
        {generation !== NONE && (
          <span>
            {text.generationOf(count(generation))}
            {tree.runs.length > 1 && run !== NONE && ` ${text.ofRun} ${shortId(tree.runs[run]!)}`}
          </span>
        )}
        {operator && (
          <span>
            {text.made} <b>{operator}</b>
          </span>
        )}
        {parents.length > 0 && <Parents {...{ tree, parents, hrefOf }} />}
        <span>
          {text.descendants} <b>{count(layout.size[creature]! - 1)}</b>
        </span>
        {status && <span class="quiet">{status}</span>}
      </div>
    </>
  );
}

interface ParentsProps extends Pick<Props, "tree" | "hrefOf"> {
  parents: number[];
}

function Parents({ tree, parents, hrefOf }: ParentsProps) {
  return (
    <span>
      {text.parents}{" "}
      {parents.map((parent, i) => (
        <span key={parent}>
          {i > 0 && ", "}
          <Linked page={hrefOf(parent)}>
            <code>{shortId(nameAt(tree, parent))}</code>
          </Linked>
        </span>
      ))}
    </span>
  );
}

const Linked = ({ page, children }: { page: string | null; children: ComponentChildren }) =>
  page === null ? <span>{children}</span> : <a href={page}>{children}</a>;
