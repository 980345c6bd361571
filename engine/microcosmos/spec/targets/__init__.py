"""Pictures that filaments fold into: digits, files and words; JAX-free."""

from .files import mnist, png, text
from .pictures import DIGITS, MAX_PIXELS, decoded, digit, encoded, field, fitted
