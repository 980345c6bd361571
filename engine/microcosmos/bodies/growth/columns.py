"""Plans from the columns of their genes."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from .plan import Plan
from .random import TYPES


def plan_of(columns: Mapping[str, Any], rows: int) -> Plan:
    """Return a plan of NumPy arrays with genes by name, and with room for `rows` segments."""
    count = len(columns["number"])
    found = {name: np.zeros(rows, kind) for name, kind in TYPES.items()}
    found["used"][:count] = True
    for name in Plan._fields[1:]:
        found[name][:count] = columns[name]
    return Plan(**found)
