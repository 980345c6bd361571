/** Pictures in one colour on a transparent ground. */

import { useEffect, useRef } from "preact/hooks";

interface Pixels {
  width: number;
  height: number;
  /** Opacities as bytes, in base64. */
  pixels: string;
}

export function pictureOf({ width, height, pixels }: Pixels, rgb: readonly number[]): OffscreenCanvas {
  const canvas = new OffscreenCanvas(width, height);
  const context = canvas.getContext("2d")!;
  const image = context.createImageData(width, height);
  const bytes = atob(pixels);
  for (let i = 0; i < width * height; i++) {
    image.data.set([...rgb, bytes.charCodeAt(i)], 4 * i);
  }
  context.putImageData(image, 0, 0);
  return canvas;
}

/** A picture in the size of its pixels; without a label, screen readers skip it. */
export function Picture({ of, rgb, label }: { of: Pixels; rgb: readonly number[]; label?: string }) {
  const canvas = useRef<HTMLCanvasElement>(null);
  useEffect(() => {
    const context = canvas.current!.getContext("2d")!;
    context.clearRect(0, 0, of.width, of.height);
    context.drawImage(pictureOf(of, rgb), 0, 0);
  }, [of.pixels, of.width, of.height]);
  const named = label === undefined ? { "aria-hidden": true } : { role: "img" as const, "aria-label": label };
  return <canvas ref={canvas} width={of.width} height={of.height} {...named} />;
}
