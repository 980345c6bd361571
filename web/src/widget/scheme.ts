/** The colour scheme of the notebook, in place of ui/scheme.ts: editors have themes of their own. */

const system = () => window.matchMedia("(prefers-color-scheme: dark)");

/** True for a dark theme of JupyterLab, VS Code or Colab; null if none is known. */
function dark(): boolean | null {
  const { jpThemeLight, vscodeThemeKind } = document.body.dataset;
  if (jpThemeLight !== undefined) return jpThemeLight === "false";
  if (vscodeThemeKind !== undefined) return !vscodeThemeKind.includes("light");
  const colab = document.documentElement.getAttribute("theme");
  return colab === null ? null : colab === "dark";
}

const observers = new Map<() => void, MutationObserver>();

/** A part of `MediaQueryList`. */
export const darkScheme = () => ({
  get matches(): boolean {
    return dark() ?? system().matches;
  },
  addEventListener(_: "change", listener: () => void): void {
    const observer = new MutationObserver(listener);
    observers.set(listener, observer);
    for (const element of [document.body, document.documentElement])
      observer.observe(element, { attributes: true });
    system().addEventListener("change", listener);
  },
  removeEventListener(_: "change", listener: () => void): void {
    observers.get(listener)?.disconnect();
    observers.delete(listener);
    system().removeEventListener("change", listener);
  },
});
