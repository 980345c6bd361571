"""What people hold in arrays, as JSON has it."""

import json
from typing import Any

import numpy as np


def dumps(document: Any) -> bytes:
    """JSON; numbers and arrays of NumPy's are written as what they hold.

    Raises `ValueError` for NaN and infinities, `TypeError` for what JSON has no word for.
    """
    return json.dumps(document, default=_plain, allow_nan=False).encode()


def _plain(value: Any) -> Any:
    if isinstance(value, np.generic | np.ndarray):
        return value.tolist()
    raise TypeError(f"JSON has no word for {type(value).__name__}; got {value!r:.80}")
