"""Studies: one file that lists sweeps, comparisons, figures and exports, and its report.

`read` reads the file, `plan` lists its runs, `carry_out` does those that are not finished, and
`report.write` makes the report of finished ones. After an interruption the same command
resumes, and ends with the same report.
"""

from .document import Study, decode, read
from .local import carry_out
from .planning import plan
from .runs import Plan, PlannedRun
