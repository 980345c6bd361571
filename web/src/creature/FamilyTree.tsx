/** A family tree: parents at the left, children at the right, bars for fitness. */

import type { Relative } from "../api/types";
import { number, shortId } from "../ui/format";
import { px } from "../ui/canvas";
import { type PlacedRelative, type FamilyLayout, ROW_HEIGHT, COLUMN_WIDTH } from "./familyLayout";
import { text } from "./text";

interface Props {
  tree: FamilyLayout;
  self: string;
  /** Null if the creature has no page here. */
  hrefOf: (creature: string) => string | null;
}

const TITLE_HEIGHT = 36;
const NAME_HEIGHT = ROW_HEIGHT - 8;

export function FamilyTree({ tree, self, hrefOf }: Props) {
  const known = tree.relatives.map(({ relative }) => relative.fitness ?? 0);
  const most = Math.max(1e-12, ...known.map(Math.abs));
  return (
    <div
      class="scroll"
      tabIndex={0}
      role="group"
      aria-label={text.familyTree}
      ref={(box) => void box?.scrollTo(box.scrollWidth, 0)}
    >
      <div class="family" style={px({ width: tree.width, height: tree.height + TITLE_HEIGHT })}>
        <svg width={tree.width} height={tree.height + TITLE_HEIGHT} aria-hidden="true">
          {tree.lines.map(([parent, child]) => (
            <path key={`${parent.relative.creature}${child.relative.creature}`} d={pathOf(parent, child)} />
          ))}
        </svg>
        {tree.columns.map(({ x, title }) => (
          <span key={title} class="family-title" style={px({ left: x, width: COLUMN_WIDTH })}>
            {title}
          </span>
        ))}
        <ul>
          {tree.relatives.map(({ relative, x, y }) => (
            <li
              key={relative.creature}
              style={px({
                left: x,
                top: TITLE_HEIGHT + y - NAME_HEIGHT / 2,
                width: COLUMN_WIDTH,
                height: NAME_HEIGHT,
              })}
            >
              <Name
                {...{ relative, most }}
                isSelf={relative.creature === self}
                href={hrefOf(relative.creature)}
              />
            </li>
          ))}
        </ul>
      </div>
    </div>
  );
}

function pathOf(parent: PlacedRelative, child: PlacedRelative): string {
  const [x, end] = [parent.x + COLUMN_WIDTH, child.x];
  const middle = (x + end) / 2;
  const [from, to] = [TITLE_HEIGHT + parent.y, TITLE_HEIGHT + child.y];
  return `M${x},${from}C${middle},${from} ${middle},${to} ${end},${to}`;
}

interface NameProps {
  relative: Relative;
  most: number;
  isSelf: boolean;
  href: string | null;
}

function Name({ relative, most, isSelf, href }: NameProps) {
  const { creature, stored, fitness } = relative;
  const title = aboutOf(relative);
  const common = {
    class: `family-name ${isSelf ? "self" : stored ? "" : "unstored"}`,
    title,
    children: (
      <>
        <code>{shortId(creature)}</code>
        {fitness !== null && (
          <span class="family-fitness" style={{ width: `${(100 * Math.abs(fitness)) / most}%` }} />
        )}
      </>
    ),
  };
  if (isSelf || !stored || href === null) return <span {...common} />;
  return <a href={href} aria-label={title} {...common} />;
}

/** Describe a relative. */
function aboutOf({ creature, stored, fitness, operator, generation }: Relative): string {
  if (!stored) return text.neverElite(shortId(creature));
  const parts = [
    fitness === null ? null : text.fitnessOf(number(fitness)),
    generation === null ? null : text.generationOf(generation),
    operator && text.madeBy(operator),
  ];
  return [shortId(creature), ...parts.filter(Boolean)].join(", ");
}
