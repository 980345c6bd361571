"""Pictures that filaments fold into: digits, files and words; JAX-free."""

from .pictures import DIGITS, MAX_PIXELS, decoded, digit, encoded, field, fitted
from .sources import mnist, png, text
