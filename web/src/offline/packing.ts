/** Bytes in a page: compressed, as base64. */

/** Ids of the elements of a page that hold data. */
export const DATA = { about: "about", motion: "motion", evaluation: "evaluation", kernel: "kernel" } as const;

export async function packed(bytes: BlobPart): Promise<string> {
  const compressed = await through(bytes, new CompressionStream("gzip"));
  let text = "";
  for (const byte of new Uint8Array(compressed)) text += String.fromCharCode(byte);
  return btoa(text);
}

export async function unpacked(text: string): Promise<ArrayBuffer> {
  const bytes = Uint8Array.from(atob(text), (character) => character.charCodeAt(0));
  return through(bytes, new DecompressionStream("gzip"));
}

const through = (bytes: BlobPart, stream: CompressionStream | DecompressionStream) =>
  new Response(new Blob([bytes]).stream().pipeThrough(stream)).arrayBuffer();
