"""`python -m validation`: run every check at full size and write the document."""

import sys
import time
from pathlib import Path

from .document import document, figure_name, save
from .paths import JAX, paths
from .rows import Findings, Result, paired
from .suite import SECTIONS, Check, Section

DOCS = Path(__file__).parents[2] / "docs"


def main(sections: tuple[Section, ...] = SECTIONS, docs: Path = DOCS) -> int:
    """Write `validation.md` and its figures; return 1 if a line fails, else 0."""
    results = [(section, measure(section)) for section in sections]
    folder = docs / "pictures"
    folder.mkdir(parents=True, exist_ok=True)
    for _, findings in results:
        for plot in findings.plots:
            save(plot, folder / figure_name(plot.name))
    (docs / "validation.md").write_text(document(results, folder.name), encoding="utf-8")
    lines = [pair for _, findings in results for pair in findings.pairs]
    for pair in lines:
        for name, row in pair.rows.items():
            if not row.passed:
                print(f"FAIL {row.quantity}, {name}: {row.value:.4g}, bar {row.bar}")
    failed = sum(not pair.passed for pair in lines)
    print(f"{docs / 'validation.md'}: {failed} lines fail.")
    return 1 if failed else 0


def measure(section: Section) -> Findings:
    """Run the checks of a section on every path that they take."""
    pairs, plots = [], []
    for number, check in enumerate(section.checks, 1):
        title = f"{section.title} {number}/{len(section.checks)}"
        findings = paired(carry_out(check, title))
        pairs += findings.pairs
        plots += findings.plots
    return Findings(pairs, plots)


def carry_out(check: Check, title: str) -> list[Result]:
    """Run a check in JAX, then in the kernel if it covers that, and print the progress."""
    results = []
    for path in (JAX,) if check.lacking else paths():
        print(f"{title}, {path.name} ...", end=" ", flush=True)
        start = time.monotonic()
        result = check.measure() if check.lacking else check.measure(path=path)
        passed, total = len(result.rows) - len(result.failed), len(result.rows)
        print(f"{passed} of {total} pass, {time.monotonic() - start:.0f} s", flush=True)
        results.append(result)
    return results


if __name__ == "__main__":
    sys.exit(main())
