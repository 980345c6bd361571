/** What a creature file says of its creature, as rows of words. */

import type { Creature } from "../api/types";
import { number, words } from "./format";

export const UNKNOWN = "unknown";
const NOT_MEASURED = "not measured";

type Row = [name: string, value: string];

export function factsOf({ identity, measured, provenance, licence }: Creature): Row[] {
  return [
    ["Fitness", measured ? number(measured.fitness, 6) : NOT_MEASURED],
    ...Object.entries({ ...measured?.descriptors, ...measured?.features }).map(
      ([name, value]): Row => [words(name), number(value, 6)],
    ),
    ["Generation", String(provenance?.generation ?? UNKNOWN)],
    ["Made by", provenance?.operator ?? UNKNOWN],
    ["Seed", String(provenance?.seed ?? UNKNOWN)],
    ["Body", `${identity.body.nodes} nodes`],
    ["World", `${identity.world.width} × ${identity.world.height} cells`],
    ["Device", measured?.device ?? UNKNOWN],
    ["Licence", licence],
  ];
}
