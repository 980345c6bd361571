"""Pictures that filaments fold into: digits, files and words; JAX-free."""

from .digits import DIGITS, digit
from .placing import MAX_PIXELS, decoded, encoded, field, fitted
from .sources import mnist, png, text
