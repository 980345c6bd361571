/** Colour maps: sequential for magnitudes, diverging for signed values. */

import type { Theme } from "./canvas";

export type Rgb = [number, number, number];

/**
 * Seventeen even samples of perceptually uniform maps of matplotlib (CC0): viridis and magma
 * (S. van der Walt and N. Smith, 2015), the latter without black, the background of a dark page;
 * cividis (Nuñez, Anderton and Renslow, PLoS ONE 13, e0199239, 2018).
 */
const SAMPLES = {
  viridis:
    "44015448186a472d7b4240863b528b33638d2c728e26828e21918c1fa08828ae803fbc735ec96284d44baddc30d8e219fde725",
  cividis:
    "00224e002e6a1a386f32436d434e6c535a6d61656f6f70737d7c788c88789b9476aba072bcae6ccdbb63dec958f0d846fee838",
  magma:
    "1a10422f11634710785d177f7521818b2981a1307eb83779cf4070e34e65f2625df97b5dfd9668feb078feca8dfde3a5fcfdbf",
};

export type Palette = keyof typeof SAMPLES;
export const PALETTES = Object.keys(SAMPLES) as Palette[];

const ANCHORS = Object.fromEntries(
  Object.entries(SAMPLES).map(([name, hex]) => [name, anchorsOf(hex)]),
) as Record<Palette, Rgb[]>;

function anchorsOf(hex: string): Rgb[] {
  const numbers = hex.match(/../g)!.map((pair) => parseInt(pair, 16));
  return Array.from({ length: numbers.length / 3 }, (_, i) => numbers.slice(3 * i, 3 * i + 3) as Rgb);
}

/** From negative blue to positive red-orange. */
const DIVERGING: Record<Theme, Rgb[]> = {
  light: anchorsOf("14428a5c98cef6f8f9e47e62921822"),
  dark: anchorsOf("94ceff2c6eb20b141ab24830ffbe94"),
};

/** From 0, dark, to 1, light. */
export function sequential(t: number, palette: Palette): Rgb {
  return between(ANCHORS[palette], t);
}

export const viridis = (t: number): Rgb => sequential(t, "viridis");

/** From −1 over 0, the background, to 1. */
export function diverging(t: number, theme: Theme): Rgb {
  return between(DIVERGING[theme], (t + 1) / 2);
}

/** The colour at a position from 0 to 1 along evenly spaced colours. */
function between(anchors: Rgb[], t: number): Rgb {
  const place = Math.min(1, Math.max(0, t)) * (anchors.length - 1);
  const i = Math.min(anchors.length - 2, Math.floor(place));
  const [a, b] = [anchors[i]!, anchors[i + 1]!];
  return a.map((value, channel) => Math.round(value + (b[channel]! - value) * (place - i))) as Rgb;
}

/** The relative luminance of a colour, from 0 to 1 (WCAG 2.2). */
export function luminance(colour: Rgb): number {
  const [red, green, blue] = colour.map((value) => {
    const share = value / 255;
    return share <= 0.04045 ? share / 12.92 : ((share + 0.055) / 1.055) ** 2.4;
  }) as Rgb;
  return 0.2126 * red + 0.7152 * green + 0.0722 * blue;
}

export function css([red, green, blue]: Rgb): string {
  return `rgb(${red} ${green} ${blue})`;
}

/** A colour lookup table: `colour(t)` for `count` values of t over [low, high], packed as canvas pixels. */
export function lut(colour: (t: number) => Rgb, count: number, [low, high]: [number, number]): Uint32Array {
  return Uint32Array.from({ length: count }, (_, i) => pixel(colour(low + ((high - low) * i) / (count - 1))));
}

/** A colour as a canvas pixel (ABGR). */
export function pixel([red, green, blue]: Rgb, alpha = 1): number {
  return ((Math.round(255 * alpha) << 24) | (blue << 16) | (green << 8) | red) >>> 0;
}
