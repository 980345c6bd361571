"""`python -m microcosmos.spec.reference > docs/spec.md`."""

import sys

from .document import reference

sys.stdout.write(reference())
