/** The genome of a creature: a network, or a row of numbers. */

import { useMemo, useState } from "preact/hooks";
import * as api from "../api/client";
import { type NetworkFormat, networkUrl } from "../api/files";
import type { Creature, Spec, Vector } from "../api/types";
import { layeredOf } from "../decode/layers";
import { type Network as Graph, networkOf } from "../decode/network";
import { GeneStrip } from "./GeneStrip";
import { NetworkGraph } from "./NetworkGraph";
import { NetworkOutputs } from "./NetworkOutputs";
import type { Playhead } from "../replay/playhead";
import { useFetched } from "../store/fetch";
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
  const about = { sha: creature.sha256, files: "nodes" in genome, control: genome.control };
  return <Network {...rest} {...about} network={network} steps={Number(task.steps)} />;
}

interface NetworkProps extends Omit<Props, "creature"> {
  sha: string;
  network: Graph;
  /** True if the network can be downloaded. */
  files: boolean;
  control: Spec;
  steps: number;
}

function Network({ sha, network, files, ...rest }: NetworkProps) {
  const { value: positions, error } = useFetched(() => api.readNetwork(sha), [sha]);
  const [selected, setSelected] = useState<number | null>(null);
  return (
    <Card id="network" title={text.network}>
      {error && <p class="wrong-text small">{error}</p>}
      {!positions && !error && <p class="quiet loading">{text.loadingNetwork}</p>}
      {positions && <NetworkGraph {...{ network, positions, selected }} onSelect={setSelected} />}
      <NetworkOutputs {...rest} {...{ network, selected }} />
      {files && (
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
