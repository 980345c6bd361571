/** Canvases in the resolution of the screen and its colour scheme; sizes in pixels. */

import type { RefObject } from "preact";
import { useEffect, useState } from "preact/hooks";
import { darkScheme } from "./scheme";

export interface Size {
  width: number;
  height: number;
}

/** The size of an element in CSS pixels; zero at first. */
export function useSize(element: RefObject<HTMLElement | null>): Size {
  const [size, setSize] = useState<Size>({ width: 0, height: 0 });
  useEffect(() => {
    const observer = new ResizeObserver(([entry]) => {
      const { width, height } = entry!.contentRect;
      setSize({ width, height });
    });
    observer.observe(element.current!);
    return () => observer.disconnect();
  }, [element]);
  return size;
}

/** True while a part of the element is on the screen. */
export function useOnScreen(element: RefObject<HTMLElement | null>): boolean {
  const [visible, setVisible] = useState(false);
  useEffect(() => {
    const observer = new IntersectionObserver(([entry]) => setVisible(entry!.isIntersecting));
    observer.observe(element.current!);
    return () => observer.disconnect();
  }, [element]);
  return visible;
}

/** Clear a canvas and return its context, in CSS pixels. */
export function prepare(canvas: HTMLCanvasElement, size: Size): CanvasRenderingContext2D {
  const density = window.devicePixelRatio || 1;
  const [width, height] = [size.width, size.height].map((side) => Math.round(side * density));
  if (canvas.width !== width || canvas.height !== height) {
    canvas.width = width!;
    canvas.height = height!;
  }
  const context = canvas.getContext("2d")!;
  context.setTransform(density, 0, 0, density, 0, 0);
  context.clearRect(0, 0, size.width, size.height);
  return context;
}

export type Theme = "light" | "dark";

export function useTheme(): Theme {
  const [dark, setDark] = useState(() => darkScheme().matches);
  useEffect(() => {
    const media = darkScheme();
    const listener = () => setDark(media.matches);
    media.addEventListener("change", listener);
    return () => media.removeEventListener("change", listener);
  }, []);
  return dark ? "dark" : "light";
}

export function prefersReducedMotion(): boolean {
  return window.matchMedia("(prefers-reduced-motion: reduce)").matches;
}

export const px = (sizes: Record<string, number>) =>
  Object.fromEntries(Object.entries(sizes).map(([name, value]) => [name, `${value}px`]));
