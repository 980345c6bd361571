/** Numbers in buffers and as base64; they are little-endian, as every machine on which browsers run. */

/** The numbers at an offset, which needs no alignment. */
export const floatsAt = (buffer: ArrayBuffer, start: number, count: number) =>
  new Float32Array(buffer.slice(start, start + 4 * count));

/**
 * Places (frame, node, 2) in cells, and where they end in the file, which holds the middle (frame, 2) of each
 * frame and then int16 units about it.
 */
export function decodePlaces(
  buffer: ArrayBuffer,
  start: number,
  { frames, nodes, scale }: { frames: number; nodes: number; scale: number },
): { places: Float32Array; end: number } {
  const middles = floatsAt(buffer, start, 2 * frames);
  const first = start + middles.byteLength;
  const units = new Int16Array(buffer.slice(first, first + 4 * frames * nodes));
  const places = Float32Array.from(units, (unit, i) => {
    return middles[2 * Math.floor(i / (2 * nodes)) + (i % 2)]! + scale * unit;
  });
  return { places, end: first + units.byteLength };
}

export function decodeFloats(text: string): Float32Array {
  const bytes = Uint8Array.from(atob(text), (character) => character.charCodeAt(0));
  if (bytes.length % 4 !== 0) {
    throw new Error(`base64 floats need a multiple of 4 bytes, got ${bytes.length}`);
  }
  return floatsAt(bytes.buffer, 0, bytes.length / 4);
}
