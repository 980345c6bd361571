/** The genome of a creature: a network, or a row of numbers. */

import { useMemo, useState } from "preact/hooks";
import { type NetworkFormat, networkUrl } from "../api/files";
import type { Creature, Spec, Vector } from "../api/types";
import { decodeFloats } from "../decode/floats";
import { layeredOf } from "../decode/layers";
import { type Network as Graph, networkOf } from "../decode/network";
import { GeneStrip } from "./GeneStrip";
import { NetworkGraph } from "./NetworkGraph";
import { NetworkOutputs } from "./NetworkOutputs";
import type { Moment } from "../replay/moment";
import { Card } from "../ui/Page";
import { FileLink } from "../ui/links";
import { text } from "./text";

const FORMS: [NetworkFormat, string][] = [
  ["svg", "SVG"],
  ["dot", "DOT"],
  ["py", "Python"],
  ["npz", "TensorNEAT"],
];

interface Props {
  creature: Creature;
  moment: Moment;
  /** Steps between frames of a moment; null without a replay. */
  every: number | null;
}

export function GenomeCard({ creature, ...shown }: Props) {
  const { genome, task } = creature.identity;
  const network = useMemo(() => {
    if ("nodes" in genome) return networkOf(genome);
    return "values" in genome ? layeredOf(genome) : null;
  }, [genome]);
  if (genome.encoding === "gait" || genome.encoding === "fold") return null;
  if (!network) return <Numbers genes={genome as Vector} />;
  const files = "nodes" in genome ? creature.sha256 : null;
  return <Network {...shown} {...{ network, files }} control={genome.control} steps={Number(task.steps)} />;
}

interface NetworkProps extends Omit<Props, "creature"> {
  network: Graph;
  /** The creature whose network can be downloaded. */
  files: string | null;
  control: Spec;
  steps: number;
}

function Network({ network, files, ...rest }: NetworkProps) {
  const [selected, choose] = useState<number | null>(null);
  return (
    <Card id="network" title={text.network}>
      <NetworkGraph network={network} selected={selected} onSelect={choose} />
      <NetworkOutputs {...rest} {...{ network, selected }} />
      {files && (
        <p class="links network-files">
          <span class="quiet small">{text.download}</span>
          {FORMS.map(([form, title]) => (
            <FileLink key={form} url={networkUrl(files, form)} name={title} />
          ))}
        </p>
      )}
    </Card>
  );
}

function Numbers({ genes }: { genes: Vector }) {
  const values = useMemo(() => decodeFloats(genes.values), [genes]);
  return (
    <Card id="genes" title={text.genes}>
      <GeneStrip values={values} />
    </Card>
  );
}
