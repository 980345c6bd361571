"""`python -m validation`: run every check at full size and write the document."""

import sys
import time
from pathlib import Path

from .document import document, figure_name, save
from .rows import Found
from .suite import SECTIONS, Section

DOCS = Path(__file__).parents[2] / "docs"


def main(sections: tuple[Section, ...] = SECTIONS, docs: Path = DOCS) -> int:
    """Write `validation.md` and its figures; return 1 if a line fails, else 0."""
    found = [(section, measure(section)) for section in sections]
    folder = docs / "pictures"
    folder.mkdir(parents=True, exist_ok=True)
    for _, one in found:
        for plot in one.plots:
            save(plot, folder / figure_name(plot.name))
    (docs / "validation.md").write_text(document(found, folder.name), encoding="utf-8")
    missed = [row for _, one in found for row in one.missed]
    for row in missed:
        print(f"FAIL {row.quantity}: {row.here:.4g}, bar {row.bar}")
    print(f"{docs / 'validation.md'}: {len(missed)} lines fail.")
    return 1 if missed else 0


def measure(section: Section) -> Found:
    """Run the checks of a section and print their progress."""
    rows, plots = [], []
    for number, check in enumerate(section.checks, 1):
        print(f"{section.title} {number}/{len(section.checks)} ...", end=" ", flush=True)
        start = time.monotonic()
        found = check()
        passed = len(found.rows) - len(found.missed)
        print(
            f"{passed} of {len(found.rows)} pass, {time.monotonic() - start:.0f} s", flush=True
        )
        rows += found.rows
        plots += found.plots
    return Found(rows, plots)


if __name__ == "__main__":
    sys.exit(main())
