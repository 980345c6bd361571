"""Everybody can use a page, as far as a program can tell: axe looks for violations."""

from typing import Any

from drive import ROOT
from playwright.sync_api import Page

AXE = ROOT / "web" / "node_modules" / "axe-core" / "axe.min.js"
RULES = ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa", "best-practice"]
RUN = """
async (tags) => {
  // What fades in has little contrast for a moment. Waits and replays turn for ever.
  const ends = ({ effect, playState }) =>
    playState === "running" && Number.isFinite(effect?.getComputedTiming().endTime);
  await Promise.allSettled(document.getAnimations().filter(ends).map((one) => one.finished));
  const { violations } = await axe.run({ runOnly: { type: "tag", values: tags } });
  const told = ({ target, failureSummary }) => [target.join(" "), failureSummary];
  return violations.map(({ id, help, nodes }) => ({ id, help, nodes: nodes.map(told) }));
}
"""
POINTS = ".mark"
"""Points of a plot: they lie where the data has them, and the table beside leads there too,
which is what target size (WCAG 2.5.8) makes exceptions for."""


def violations(page: Page) -> list[str]:
    """What axe finds on a page, where, and what it needs."""
    page.evaluate(AXE.read_text())  # Pages run no script that is not the server's own.
    found: list[dict[str, Any]] = page.evaluate(RUN, RULES)
    return [
        f"{one['id']}: {one['help']}; {target}: {summary}"
        for one in found
        for target, summary in one["nodes"]
        if not (one["id"] == "target-size" and POINTS in target)
    ]
