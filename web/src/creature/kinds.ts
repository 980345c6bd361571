/** Kinds of creatures, by their genome. */

import type { Creature } from "../api/types";

/** True if the creature swims; a folding filament only takes a shape. */
export const swims = ({ identity }: Creature) => identity.genome.encoding !== "fold";

/** True if the creature has genes that evolve. */
export const isEvolved = (creature: Creature) =>
  swims(creature) && creature.identity.genome.encoding !== "gait";
