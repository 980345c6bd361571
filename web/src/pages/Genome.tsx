/** What a creature has inherited: a network, or a row of numbers. */

import { useMemo } from "preact/hooks";
import { type Form, networkUrl } from "../api/client";
import type { Genes, Genome as Inherited, Vector } from "../api/types";
import { decodeFloats } from "../frames/base64";
import { networkOf } from "../frames/network";
import { GeneStrip } from "../view/network/GeneStrip";
import { NetworkGraph } from "../view/network/NetworkGraph";
import { FileLink } from "./FileLink";

const FORMS: [Form, string][] = [
  ["svg", "SVG"],
  ["dot", "DOT"],
  ["py", "Python"],
  ["npz", "TensorNEAT"],
];

interface Props {
  sha: string;
  genome: Inherited;
}

export function Genome({ sha, genome }: Props) {
  if (genome.encoding === "gait" || genome.encoding === "fold") return null;
  if ("nodes" in genome) return <Network sha={sha} genes={genome} />;
  return <Numbers genes={genome} />;
}

function Network({ sha, genes }: { sha: string; genes: Genes }) {
  const network = useMemo(() => networkOf(genes), [genes]);
  return (
    <section class="card" aria-labelledby="network-title">
      <h2 id="network-title">Network</h2>
      <NetworkGraph network={network} />
      <p class="links network-files">
        <span class="quiet small">Keep it as</span>
        {FORMS.map(([form, title]) => (
          <FileLink key={form} url={networkUrl(sha, form)} name={title} />
        ))}
      </p>
    </section>
  );
}

function Numbers({ genes }: { genes: Vector }) {
  const values = useMemo(() => decodeFloats(genes.values), [genes]);
  return (
    <section class="card" aria-labelledby="genes-title">
      <h2 id="genes-title">Genes</h2>
      <GeneStrip values={values} />
    </section>
  );
}
