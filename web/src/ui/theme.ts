/** The colour scheme of the system, for canvases; everything else is CSS. */

import { useEffect, useState } from "preact/hooks";

const query = () => window.matchMedia("(prefers-color-scheme: dark)");

export type Theme = "light" | "dark";

export function useTheme(): Theme {
  const [dark, setDark] = useState(() => query().matches);
  useEffect(() => {
    const media = query();
    const listener = () => setDark(media.matches);
    media.addEventListener("change", listener);
    return () => media.removeEventListener("change", listener);
  }, []);
  return dark ? "dark" : "light";
}

export function prefersReducedMotion(): boolean {
  return window.matchMedia("(prefers-reduced-motion: reduce)").matches;
}
