/** The choice of the coloured measure and of the palette. */

import type { Archive } from "../api/types";
import { Select } from "../ui/Select";
import { PALETTES, type Palette } from "../ui/colours";
import { words } from "../ui/format";
import { coloursOf } from "./colouring";
import { text } from "./text";

interface Props {
  archive: Archive;
  colour: string;
  palette: Palette;
  onColour: (name: string) => void;
  onPalette: (palette: string) => void;
}

export function ColourSelect({ archive, colour, palette, onColour, onPalette }: Props) {
  const palettes = PALETTES.map((name): [string, string] => [name, words(name)]);
  return (
    <p class="axis-choice">
      <Select title={text.colour} choices={coloursOf(archive)} value={colour} onChange={onColour} />
      <Select title={text.palette} choices={palettes} value={palette} onChange={onPalette} />
    </p>
  );
}
