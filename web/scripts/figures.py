"""Print the kinds of figures for the page: `.venv/bin/python web/scripts/figures.py`."""

import json

from microcosmos.archive.report import FIGURES


def main() -> None:
    rows = []
    for one in FIGURES:
        if "*" in one.name or one.adds or not one.curve:
            flags = json.dumps({"adds": one.adds, "curve": one.curve})[1:-1]
            rows.append(f'  "{one.name}": {{ {flags} }}')
    print("{\n" + ",\n".join(rows) + "\n}")


if __name__ == "__main__":
    main()
