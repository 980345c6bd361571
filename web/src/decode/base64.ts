/** Numbers as creature files carry them: base64 of little-endian float32. */

export function decodeFloats(text: string): Float32Array {
  const raw = atob(text);
  if (raw.length % 4 !== 0) {
    throw new Error(`base64 floats need a multiple of 4 bytes, got ${raw.length}`);
  }
  const view = new DataView(new ArrayBuffer(raw.length));
  for (let i = 0; i < raw.length; i++) view.setUint8(i, raw.charCodeAt(i));
  return Float32Array.from({ length: raw.length / 4 }, (_, i) => view.getFloat32(4 * i, true));
}
