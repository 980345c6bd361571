/** Keys that work on every page. */

import { useListener } from "../store/polling";
import { navigate } from "../store/router";
import { TEXT_FIELDS } from "../ui/forms";

export function usePageKeys(toggleShortcuts: () => void): void {
  const actions: Record<string, () => void> = {
    "?": toggleShortcuts,
    "/": () => document.querySelector<HTMLInputElement>("main input[type=search]")?.focus(),
    n: () => navigate("/new"),
  };
  useListener("keydown", (event: KeyboardEvent) => {
    const target = event.target as Element;
    if (event.defaultPrevented || event.ctrlKey || event.metaKey || event.altKey) return;
    if (target.closest?.(TEXT_FIELDS) || (target.closest?.("dialog") && event.key !== "?")) return;
    const action = actions[event.key];
    if (!action) return;
    event.preventDefault();
    action();
  });
}
