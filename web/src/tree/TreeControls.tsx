/** Controls above a tree: colours, what is shown, zoom, files. */

import { type PhylogenyFile, phylogenyUrl, saveText } from "../api/files";
import { setQuery } from "../store/router";
import { FileLink } from "../ui/links";
import { Check, Segments, Select } from "../ui/Select";
import type { ColourBy } from "./shades";
import type { Stage } from "./stage";
import { ZOOM_STEP } from "./keys";
import { text } from "./text";

interface Props {
  /** The path of the run or creature. */
  of: string;
  by: ColourBy;
  whole: boolean;
  survivors: boolean;
  zoom: number;
  stage: () => Stage;
  /** The present view as SVG. */
  onDrawing: () => string;
}

const COLOURS = [
  ["fitness", text.fitness],
  ["operator", text.operator],
] as const;
const SHOWN = [
  ["all", text.all],
  ["survivors", text.survivors],
] as const;
const FILES: [PhylogenyFile, string, string][] = [
  ["csv", text.csv, text.csvAbout],
  ["nwk", text.newick, text.newickAbout],
];

export function TreeControls({ of, by, whole, survivors, zoom, stage, onDrawing }: Props) {
  return (
    <div class="row tree-controls">
      <Segments
        label={text.colour}
        choices={COLOURS}
        value={by}
        onSelect={(name) => setQuery({ colour: name === "fitness" ? null : name })}
      />
      <Select
        title={text.shownCreatures}
        choices={SHOWN}
        value={survivors ? "survivors" : "all"}
        onChange={(name) => setQuery({ show: name === "all" ? null : name })}
      />
      <Check title={text.collapse} on={!whole} onChange={(on) => setQuery({ lines: on ? null : "all" })} />
      <div class="actions" role="group" aria-label={text.zoom}>
        <button
          class="small-button"
          aria-label={text.zoomOut}
          disabled={zoom <= 0}
          onClick={() => stage().zoom(-ZOOM_STEP)}
        >
          −
        </button>
        <button
          class="small-button"
          aria-label={text.zoomIn}
          disabled={zoom >= 1}
          onClick={() => stage().zoom(ZOOM_STEP)}
        >
          +
        </button>
        <button class="small-button" onClick={() => stage().all()}>
          {text.wholeTree}
        </button>
      </div>
      <span class="spring" />
      <span class="tree-files">
        {FILES.map(([kind, name, about]) => (
          <FileLink key={kind} url={phylogenyUrl(of, kind)} name={name} title={about} />
        ))}
        <button title={text.svgAbout} onClick={() => saveText(onDrawing(), "tree.svg", "image/svg+xml")}>
          {text.svg}
        </button>
      </span>
    </div>
  );
}
