"""Ten handwritten digits of 8 × 8 pixels.

The first of each class in "Optical Recognition of Handwritten Digits", E. Alpaydin and
C. Kaynak (1998), UCI Machine Learning Repository, doi:10.24432/C50P49, CC BY 4.0; the same ten
that scikit-learn's `load_digits` begins with.
"""

import numpy as np

GREYS = "0123456789abcdefg"

DIGITS = (
    "005d9100 00dfaf50 03f20b80 04c00880 05800980 04b01c70 02e5ac00 006da000",
    "000cd500 000bg900 003fg600 07fgg200 001gg300 001gg600 001gg600 000bga00",
    "0004fc00 003gfe00 008d8g00 0016fb00 018df100 09gg5000 03dggb50 0003bg90",
    "007fd100 08d6f400 021dd000 002fb100 0001cc10 00001a80 00845e90 007dd900",
    "0001b000 00078000 001d6220 007f0980 05ga0g60 04fgdg10 0003fa00 0002g400",
    "00ca0000 00egge00 00dgfa10 00bgg700 00047g70 00004g90 0054cg40 009gga00",
    "000cd000 005g8000 00dg3000 00ed0000 00fc7200 00dgdg30 007gbf80 0019fb30",
    "0078dgf1 00774bc0 00008d10 0488ff60 02bff400 000g5000 009f1000 00d50000",
    "009e8100 00ceec00 009a0f40 003gce20 004gg200 03g8ad20 01f13g80 00bgfb10",
    "00bc0000 02gggd00 03gcae00 01g1cf00 00dg9f20 000309b0 00009f40 009cd300",
)
"""Rows from the top, one character per pixel."""


def digit(number: int) -> np.ndarray:
    """Return the ink (row, column) of a digit, from 0 to 1."""
    rows = DIGITS[number].split()
    return np.array([[GREYS.index(pixel) for pixel in row] for row in rows]) / 16
