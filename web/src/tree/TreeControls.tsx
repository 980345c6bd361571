/** Controls above a tree: colours, what is shown, zoom, files; and the legend below it. */

import { type PhylogenyFile, phylogenyUrl, saveFile } from "../api/files";
import { setQuery } from "../store/router";
import { FileLink } from "../ui/links";
import { Check, Segments, Select } from "../ui/Select";
import { type ColourBy, type Shades, type Shape, fitnessColour, operatorColour, shapeOf } from "./shades";
import type { Stage } from "./stage";
import { ZOOM_STEP } from "./gestures";
import { text } from "./text";
import type { Phylogeny } from "../decode/phylogeny";
import { ColourBar } from "../ui/ColourBar";
import type { Theme } from "../ui/canvas";
import { number } from "../ui/format";

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
      <Zoom zoom={zoom} stage={stage} />
      <span class="spring" />
      <span class="tree-files">
        {FILES.map(([kind, name, about]) => (
          <FileLink key={kind} url={phylogenyUrl(of, kind)} name={name} title={about} />
        ))}
        <button
          title={text.svgAbout}
          onClick={() => saveFile(new Blob([onDrawing()], { type: "image/svg+xml" }), "tree.svg")}
        >
          {text.svg}
        </button>
      </span>
    </div>
  );
}

function Zoom({ zoom, stage }: Pick<Props, "zoom" | "stage">) {
  return (
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
  );
}

interface TreeLegendProps {
  tree: Phylogeny;
  shades: Shades;
  theme: Theme;
  collapsed: boolean;
}

export function TreeLegend({ tree, shades: { by, range }, theme, collapsed }: TreeLegendProps) {
  const numbers = [range[0], (range[0] + range[1]) / 2, range[1]].map((value) => number(value));
  return (
    <div class="tree-legend small">
      {by === "fitness" ? (
        <ColourBar
          name={text.fitness}
          label={text.legend(text.fitness, numbers[0]!, numbers[2]!)}
          colourAt={(share) => fitnessColour(share, theme)}
          numbers={numbers}
        />
      ) : (
        <ul class="row tree-operators" aria-label={text.operator}>
          {tree.operators.map((name, i) => (
            <li key={name} class="compact">
              <Dot shape={shapeOf(tree, i)} colour={operatorColour(tree, i, theme)} />
              {name}
            </li>
          ))}
        </ul>
      )}
      <p class="quiet row">
        <span>{text.legendEdge}</span>
        <span class="compact">
          <Dot shape="circle" colour="currentColor" />
          {text.legendElite}
        </span>
        <span class="compact">
          <Dot shape="circle" colour="currentColor" hollow />
          {text.legendLost}
        </span>
        {collapsed && <span>{text.legendCount}</span>}
      </p>
    </div>
  );
}

const PATHS: Record<Shape, string> = {
  circle: "M11 6A5 5 0 1 1 1 6A5 5 0 1 1 11 6z",
  square: "M1.5 1.5h9v9h-9z",
  diamond: "M6 0.5L11.5 6L6 11.5L0.5 6z",
  triangle: "M6 1L11.5 10.5H0.5z",
};

function Dot({ shape, colour, hollow = false }: { shape: Shape; colour: string; hollow?: boolean }) {
  return (
    <svg class="tree-dot" viewBox="0 0 12 12" aria-hidden="true">
      <path d={PATHS[shape]} fill={hollow ? "none" : colour} stroke={colour} stroke-width="1.4" />
    </svg>
  );
}
