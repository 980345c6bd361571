/** Arranges a tree and paints pictures of it, so that the page stays smooth. */

import { type Phylogeny, decodePhylogeny } from "../decode/phylogeny";
import { type Chains, type TreeLayout, chainsOf, layoutOf, surviving } from "./layout";
import { paint } from "./paint";
import type { Picture, Request } from "./painter";
import { type Shades, shadesOf } from "./shades";
import { strokesOf } from "./strokes";

let tree: Phylogeny;
let layout: TreeLayout;
let chains: Chains;
let shades: { key: string; value: Shades };

onmessage = ({ data }: MessageEvent<Request>) => {
  if (data.kind === "arrange") {
    if (data.buffer) tree = decodePhylogeny(data.buffer);
    const all = layoutOf(tree);
    layout = data.survivors ? layoutOf(tree, surviving(tree, all.parent)) : all;
    chains = chainsOf(layout);
    shades = { key: "", value: shadesOf(tree, "fitness", "light") };
    postMessage({ kind: "arranged", layout, chains });
  } else {
    const bitmap = painted(data);
    postMessage({ kind: "painted", picture: data, bitmap }, { transfer: [bitmap] });
  }
};

function painted({ view, scales, size, density, at, whole, by, theme }: Picture): ImageBitmap {
  const key = `${by} ${theme}`;
  if (shades.key !== key) shades = { key, value: shadesOf(tree, by, theme) };
  const { shade, colours } = shades.value;
  const canvas = new OffscreenCanvas(
    Math.max(1, Math.round(size.width * density)),
    Math.max(1, Math.round(size.height * density)),
  );
  const context = canvas.getContext("2d")!;
  context.scale(density, density);
  const scene = { tree, layout, chains, view, scales, size, at, whole, shade, shades: colours.length };
  paint(context, strokesOf(scene), tree, shades.value, theme);
  return canvas.transferToImageBitmap();
}
