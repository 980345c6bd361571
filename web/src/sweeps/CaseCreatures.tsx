/** The best creature of every run of a sweep, by case, swimming on one clock. */

import type { Member } from "../api/types";
import { SwimmingBody } from "../replay/SwimmingBody";
import { readTankBatch, usePoses } from "../store/poses";
import { number } from "../ui/format";
import { Card } from "../ui/Page";
import { SideBySide } from "../ui/links";
import { CaseName } from "./CaseTables";
import { type ShownCase, memberName } from "./summaryPlots";
import { text } from "./text";

type Found = Member & { face: string; best: number };

const foundOf = ({ summary }: ShownCase): Found[] =>
  summary.members.filter((member): member is Found => member.face !== null && member.best !== null);

export function CaseCreatures({ shown }: { shown: ShownCase[] }) {
  const rows = shown.map((one) => ({ one, found: foundOf(one) })).filter(({ found }) => found.length > 0);
  const visible = rows.flatMap(({ found }) => found.map(({ face }) => ({ creature: face })));
  const poses = usePoses(readTankBatch, visible, false);
  if (rows.length === 0) return null;
  const best = [...new Set(rows.map(({ found }) => fittest(found).face))];
  return (
    <Card
      id="creatures"
      title={text.creatures}
      note={text.creaturesAbout}
      actions={<SideBySide creatures={best} title={text.sideBySide} />}
    >
      <ul class="case-creatures">
        {rows.map(({ one, found }) => (
          <li key={one.caseIndex}>
            <span>
              <CaseName shown={one} />
            </span>
            <ul>
              {found.map((member) => (
                <li key={member.run}>
                  <a
                    href={`/creatures/${member.face}?run=${member.run}`}
                    title={text.bestOf(memberName(member))}
                  >
                    <SwimmingBody stream={poses.get(member.face) ?? null} onWater />
                    <span class="small">{number(member.best)}</span>
                  </a>
                </li>
              ))}
            </ul>
          </li>
        ))}
      </ul>
    </Card>
  );
}

const fittest = (found: Found[]) => found.reduce((best, one) => (one.best > best.best ? one : best));
