"""`python -m validation`: run every check at full size and write the document."""

import sys
import time
from pathlib import Path

from .document import document, figure_name, save
from .rows import Result
from .suite import SECTIONS, Section

DOCS = Path(__file__).parents[2] / "docs"


def main(sections: tuple[Section, ...] = SECTIONS, docs: Path = DOCS) -> int:
    """Write `validation.md` and its figures; return 1 if a line fails, else 0."""
    results = [(section, measure(section)) for section in sections]
    folder = docs / "pictures"
    folder.mkdir(parents=True, exist_ok=True)
    for _, result in results:
        for plot in result.plots:
            save(plot, folder / figure_name(plot.name))
    (docs / "validation.md").write_text(document(results, folder.name), encoding="utf-8")
    failed = [row for _, result in results for row in result.failed]
    for row in failed:
        print(f"FAIL {row.quantity}: {row.value:.4g}, bar {row.bar}")
    print(f"{docs / 'validation.md'}: {len(failed)} lines fail.")
    return 1 if failed else 0


def measure(section: Section) -> Result:
    """Run the checks of a section and print their progress."""
    rows, plots = [], []
    for number, check in enumerate(section.checks, 1):
        print(f"{section.title} {number}/{len(section.checks)} ...", end=" ", flush=True)
        start = time.monotonic()
        result = check()
        passed, total = len(result.rows) - len(result.failed), len(result.rows)
        print(f"{passed} of {total} pass, {time.monotonic() - start:.0f} s", flush=True)
        rows += result.rows
        plots += result.plots
    return Result(rows, plots)


if __name__ == "__main__":
    sys.exit(main())
