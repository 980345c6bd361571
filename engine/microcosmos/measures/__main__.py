"""Print what follows from the table of measures; `derived` names the files."""

import sys

from . import derived

if __name__ == "__main__":
    forms = {"index": derived.index, "page": derived.page, "table": derived.table}
    sys.stdout.write(forms[sys.argv[1]]())
