/** The genome of a creature: a network, or a row of numbers. */

import { useMemo, useState } from "preact/hooks";
import { type NetworkFormat, networkUrl } from "../api/files";
import type { Creature, Spec, Vector } from "../api/types";
import { layeredOf } from "../decode/layers";
import { type Network as Graph, networkOf } from "../decode/network";
import { GeneStrip } from "./GeneStrip";
import { NetworkGraph } from "./NetworkGraph";
import { NetworkOutputs } from "./NetworkOutputs";
import type { Playhead } from "../replay/playhead";
import { Card } from "../ui/Page";
import { FileLink } from "../ui/links";
import { text } from "./text";

const FORMATS: [NetworkFormat, string][] = [
  ["svg", "SVG"],
  ["dot", "DOT"],
  ["py", "Python"],
  ["npz", "TensorNEAT"],
];

interface Props {
  creature: Creature;
  playhead: Playhead;
  /** Steps between frames of the replay; null without a replay. */
  every: number | null;
}

export function GenomeCard({ creature, ...rest }: Props) {
  const { genome, task } = creature.identity;
  const network = useMemo(() => {
    if ("nodes" in genome) return networkOf(genome);
    return "values" in genome ? layeredOf(genome) : null;
  }, [genome]);
  if (genome.encoding === "gait" || genome.encoding === "fold") return null;
  if (!network) {
    return (
      <Card id="genes" title={text.genes}>
        <GeneStrip genes={genome as Vector} />
      </Card>
    );
  }
  const sha = "nodes" in genome ? creature.sha256 : null;
  return <Network {...rest} {...{ network, sha }} control={genome.control} steps={Number(task.steps)} />;
}

interface NetworkProps extends Omit<Props, "creature"> {
  network: Graph;
  /** The creature whose network can be downloaded; null without a file. */
  sha: string | null;
  control: Spec;
  steps: number;
}

function Network({ network, sha, ...rest }: NetworkProps) {
  const [selected, setSelected] = useState<number | null>(null);
  return (
    <Card id="network" title={text.network}>
      <NetworkGraph network={network} selected={selected} onSelect={setSelected} />
      <NetworkOutputs {...rest} {...{ network, selected }} />
      {sha && (
        <p class="links network-files">
          <span class="quiet small">{text.download}</span>
          {FORMATS.map(([format, title]) => (
            <FileLink key={format} url={networkUrl(sha, format)} name={title} />
          ))}
        </p>
      )}
    </Card>
  );
}
