"""Faults of a page's layout, and violations of accessibility that axe finds."""

from typing import Any

from drive import ROOT
from playwright.sync_api import Page

THEMES = ("light", "dark")
WIDTHS = {1280: 900, 820: 1100, 390: 844}
"""Widths of windows, and their heights: a desk, a tablet, a phone."""

SCRIPT = r"""
() => {
  const faults = [];
  const named = (e) => {
    const kind = e.localName + (e.className && e.className.baseVal === undefined
      ? "." + [...e.classList].join(".") : "");
    return `${kind} "${(e.innerText ?? "").trim().slice(0, 40).replace(/\s+/g, " ")}"`;
  };
  const shown = (e) => e.checkVisibility({ visibilityProperty: true, opacityProperty: true })
    && !e.closest(".unseen, [aria-hidden=true]");
  const root = document.documentElement;
  if (root.scrollWidth > root.clientWidth) {
    const wide = [...document.querySelectorAll("body *")].filter((e) => shown(e)
      && e.getBoundingClientRect().right > root.clientWidth + 1);
    faults.push(`the page is ${root.scrollWidth} wide in a window of ${root.clientWidth}: `
      + wide.slice(-3).map(named).join(", "));
  }
  const words = (e) => [...e.childNodes].some((n) => n.nodeType === 3 && n.data.trim());
  const clips = (overflow) => overflow === "hidden" || overflow === "clip";
  for (const e of document.querySelectorAll("body *:not(select, option, input, canvas)")) {
    if (!shown(e) || !e.innerText?.trim()) continue;
    const { overflowX, overflowY, display, textOverflow } = getComputedStyle(e);
    if (display === "inline" || (textOverflow === "ellipsis" && e.title)) continue;
    if (clips(overflowX) && e.scrollWidth > e.clientWidth + 1)
      faults.push(`cut at the side: ${named(e)}, ${e.scrollWidth} in ${e.clientWidth}`);
    if (clips(overflowY) && words(e) && e.scrollHeight > e.clientHeight + 3)
      faults.push(`cut below: ${named(e)}, ${e.scrollHeight} in ${e.clientHeight}`);
  }
  const meet = (a, b) => Math.min(a.right, b.right) - Math.max(a.left, b.left) > 1
    && Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top) > 1;
  for (const header of document.querySelectorAll("header, .card-head, .crumbs")) {
    const parts = [...header.children].filter((e) => shown(e)
      && getComputedStyle(e).position !== "absolute");
    parts.forEach((a, i) => parts.slice(i + 1).forEach((b) => {
      if (meet(a.getBoundingClientRect(), b.getBoundingClientRect()))
        faults.push(`${named(a)} overlaps ${named(b)}`);
    }));
    const box = header.getBoundingClientRect();
    for (const e of parts) if (e.getBoundingClientRect().right > box.right + 1)
      faults.push(`${named(e)} sticks out of its header`);
  }
  faults.push(...overlaid());
  return faults;

  // Words on words: lines of text that are drawn over each other, unless one of them floats.
  function overlaid() {
    const lines = [];
    const walk = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
    for (let node; (node = walk.nextNode()); ) {
      const e = node.parentElement;
      if (!node.data.trim() || !shown(e) || e.closest("option, [role=tooltip]")) continue;
      if (floats(e)) continue;
      const range = document.createRange();
      range.selectNodeContents(node);
      for (const box of range.getClientRects()) if (box.width > 2) lines.push({ box, e, node });
    }
    lines.sort((a, b) => a.box.top - b.box.top);
    const found = [];
    lines.forEach((a, i) => {
      for (let j = i + 1; j < lines.length && lines[j].box.top < a.box.bottom; j++) {
        const b = lines[j];
        const width = Math.min(a.box.right, b.box.right) - Math.max(a.box.left, b.box.left);
        const height = Math.min(a.box.bottom, b.box.bottom) - b.box.top;
        const much = 0.4 * Math.min(a.box.height, b.box.height);
        if (a.node !== b.node && width > 2 && height > much)
          found.push(`words on words: ${named(a.e)} and ${named(b.e)}`);
      }
    });
    return found;
  }

  function floats(e) {
    for (; e; e = e.parentElement)
      if (["fixed", "sticky"].includes(getComputedStyle(e).position)) return true;
    return false;
  }
}
"""


def faults(page: Page) -> list[str]:
    """Sentences about what is too wide, cut off, or drawn over something else."""
    return page.evaluate(SCRIPT)


AXE = ROOT / "web" / "node_modules" / "axe-core" / "axe.min.js"
RULES = ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa", "best-practice"]
RUN = """
async (tags) => {
  // What fades in has little contrast for a moment. Waits and replays turn for ever.
  const ends = ({ effect, playState }) =>
    playState === "running" && Number.isFinite(effect?.getComputedTiming().endTime);
  await Promise.allSettled(document.getAnimations().filter(ends).map((one) => one.finished));
  const { violations } = await axe.run({ runOnly: { type: "tag", values: tags } });
  const pair = ({ target, failureSummary }) => [target.join(" "), failureSummary];
  return violations.map(({ id, help, nodes }) => ({ id, help, nodes: nodes.map(pair) }));
}
"""
POINTS = ".mark"
"""Points of a plot: they lie where the data has them, and the table beside leads there too,
which is what target size (WCAG 2.5.8) makes exceptions for."""


def violations(page: Page) -> list[str]:
    page.evaluate(AXE.read_text())  # Pages run no script that is not the server's own.
    found: list[dict[str, Any]] = page.evaluate(RUN, RULES)
    return [
        f"{one['id']}: {one['help']}; {target}: {summary}"
        for one in found
        for target, summary in one["nodes"]
        if not (one["id"] == "target-size" and POINTS in target)
    ]
