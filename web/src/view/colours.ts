/** Colour maps: perceptually uniform for magnitudes, diverging around zero for vorticity. */

export type Rgb = [number, number, number];

/**
 * Viridis (S. van der Walt and N. Smith) as a polynomial of sixth degree for each channel,
 * fitted by M. Zucker; map and fit are both in the public domain (CC0).
 */
const VIRIDIS: Rgb[] = [
  [0.2777273272, 0.0054073445, 0.3340998053],
  [0.1050930431, 1.4046135299, 1.3845901627],
  [-0.3308618287, 0.2148475595, 0.095095163],
  [-4.634230499, -5.7991009734, -19.3324409563],
  [6.2282699363, 14.1799333668, 56.6905526007],
  [4.776384997, -13.7451453777, -65.3530326334],
  [-5.4354558559, 4.6458526122, 26.3124352496],
];

/** From the most negative to the most positive, evenly spaced; blue against red-orange. */
const DIVERGING: Record<"light" | "dark", Rgb[]> = {
  light: [
    [20, 66, 138],
    [92, 152, 206],
    [246, 248, 249],
    [228, 126, 98],
    [146, 24, 34],
  ],
  dark: [
    [148, 206, 255],
    [44, 110, 178],
    [11, 20, 26],
    [178, 72, 48],
    [255, 190, 148],
  ],
};

export function viridis(t: number): Rgb {
  const x = Math.min(1, Math.max(0, t));
  return [0, 1, 2].map((channel) => {
    const value = VIRIDIS.reduceRight((sum, row) => sum * x + row[channel]!, 0);
    return Math.round(255 * Math.min(1, Math.max(0, value)));
  }) as Rgb;
}

export function diverging(t: number, theme: "light" | "dark"): Rgb {
  const anchors = DIVERGING[theme];
  const place = ((Math.min(1, Math.max(-1, t)) + 1) / 2) * (anchors.length - 1);
  const i = Math.min(anchors.length - 2, Math.floor(place));
  const [a, b] = [anchors[i]!, anchors[i + 1]!];
  return a.map((value, channel) => {
    return Math.round(value + (b[channel]! - value) * (place - i));
  }) as Rgb;
}

export function css([red, green, blue]: Rgb): string {
  return `rgb(${red} ${green} ${blue})`;
}

/** `colour(t)` for `count` values of t over [low, high], packed as canvas pixels (ABGR). */
export function table(
  colour: (t: number) => Rgb,
  count: number,
  [low, high]: [number, number],
): Uint32Array {
  return Uint32Array.from({ length: count }, (_, i) => {
    const [red, green, blue] = colour(low + ((high - low) * i) / (count - 1));
    return 0xff000000 | (blue << 16) | (green << 8) | red;
  });
}
