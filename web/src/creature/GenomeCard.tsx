/** The genome of a creature: a network, or a row of numbers. */

import { useMemo, useState } from "preact/hooks";
import * as api from "../api/client";
import { type NetworkFormat, networkUrl } from "../api/files";
import type { Creature, Spec, Vector } from "../api/types";
import { type Network as Graph, networkOf } from "../decode/network";
import { NetworkGraph } from "./NetworkGraph";
import { NetworkOutputs } from "./NetworkOutputs";
import type { Playhead } from "../replay/clock";
import { useFetched } from "../store/fetch";
import { Card } from "../ui/Page";
import { FileLink } from "../ui/links";
import { text } from "./text";
import { decodeFloats } from "../decode/floats";
import { count, number, percent } from "../ui/format";

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
  const network = useMemo(() => ("nodes" in genome ? networkOf(genome) : null), [genome]);
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

/** Above this number of genes, each bar shows the largest of several. */
const MAX_BARS = 400;

function GeneStrip({ genes }: { genes: Vector }) {
  const values = useMemo(() => decodeFloats(genes.values), [genes]);
  const bars = useMemo(() => barsOf(values), [values]);
  const meanSize = values.reduce((sum, value) => sum + Math.abs(value), 0) / (values.length || 1);
  const shareAtBounds = values.filter((value) => Math.abs(value) >= 1).length / (values.length || 1);
  const summary = text.genesSummary(count(values.length), number(meanSize));
  return (
    <figure class="genes">
      <svg viewBox={`0 -1 ${bars.length} 2`} preserveAspectRatio="none" role="img" aria-label={summary}>
        <path class="positive" d={pathOf(bars, (value) => Math.max(0, value))} />
        <path class="negative" d={pathOf(bars, (value) => Math.min(0, value))} />
        <path class="zero" d={`M0,0H${bars.length}`} />
      </svg>
      <figcaption class="row">
        <span class="key positive">{text.positiveGenes}</span>
        <span class="key negative">{text.negativeGenes}</span>
        <span class="quiet">
          {summary}
          {shareAtBounds > 0 && text.atBounds(percent(shareAtBounds))}
        </span>
      </figcaption>
    </figure>
  );
}

/** At most `MAX_BARS` values, each the largest in size of those that it represents. */
export function barsOf(values: Float32Array): number[] {
  const perBar = Math.max(1, Math.ceil(values.length / MAX_BARS));
  return Array.from({ length: Math.ceil(values.length / perBar) }, (_, k) =>
    values
      .subarray(k * perBar, (k + 1) * perBar)
      .reduce((most, value) => (Math.abs(value) > Math.abs(most) ? value : most), 0),
  );
}

function pathOf(bars: number[], part: (value: number) => number): string {
  return bars
    .map((value, i) => [i, part(value)] as const)
    .filter(([, value]) => value !== 0)
    .map(([i, value]) => `M${i + 0.1},0V${-value.toFixed(4)}h0.8V0z`)
    .join("");
}
