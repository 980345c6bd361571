"""Elementary functions in double precision whose bits are the same on every processor.

They only add, multiply, divide and take square roots, element by element, as IEEE 754 rounds.
NumPy's own differ with the processor's vectors and the C library, and its matrix products and
decompositions with the library that carries them out.
"""

from decimal import Context, Decimal, localcontext
from math import factorial, sqrt

import numpy as np

QUARTER = 1.57079632673412561417, 6.07710050630396597660e-11, 2.02226624871116645580e-21
"""A quarter turn in three parts, whose multiples below 2²⁰ are exact (those of fdlibm)."""
LN_2 = 6.93147180369123816490e-01, 1.90821492927058770002e-10
"""The logarithm of 2 in two parts (those of fdlibm); multiples of the first are exact."""
LN_10 = 2.302585092994046
SWEEPS = 60
"""Most sweeps of rotations; about eight are enough."""


# Series end where the next term is below 10⁻¹⁸ of the sum, beyond the last bit of a double.


def sine(x: np.ndarray | float) -> np.ndarray:
    """Return the sine of angles in rad, accurate up to 10⁶ rad."""
    return _of_quarter(x, 0)


def cosine(x: np.ndarray | float) -> np.ndarray:
    """Return the cosine of angles in rad, accurate up to 10⁶ rad."""
    return _of_quarter(x, 1)


def angle(y: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Return the angle of (x, y) in rad, within ±π; 0 at the origin."""
    wide, high = np.abs(x), np.abs(y)
    longest = np.maximum(wide, high)
    t = np.minimum(wide, high) / np.where(longest > 0, longest, 1.0)
    # The tangent of half the angle, twice: within 1/5 the series converges fast.
    for _ in range(2):
        t = t / (1 + np.sqrt(1 + t * t))
    series = [(-1) ** n / (2 * n + 1) for n in range(14)]
    angle = 4 * t * _polynomial(series, t * t)
    angle = np.where(high > wide, np.pi / 2 - angle, angle)
    angle = np.where(x < 0, np.pi - angle, angle)
    return np.where(np.signbit(y), -angle, angle)


def length(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Return the length of (x, y); squares must not overflow."""
    return np.sqrt(x * x + y * y)


def exponential(x: np.ndarray) -> np.ndarray:
    """Return the exponential; 0 below −700."""
    x = np.asarray(x, float)
    vanishes, x = x < -700, np.maximum(x, -700.0)
    power = np.rint(x * 1.4426950408889634)
    rest = (x - power * LN_2[0]) - power * LN_2[1]
    series = [1 / factorial(n) for n in range(15)]
    value = np.ldexp(_polynomial(series, rest), power.astype(int))
    return np.where(vanishes, 0.0, value)


def logarithm(x: np.ndarray | float) -> np.ndarray:
    """Return the natural logarithm of positive numbers."""
    part, power = np.frexp(np.asarray(x, float))
    # Within √½ and √2, where the series in t = (x − 1) / (x + 1) needs the fewest terms.
    low = part < 0.7071067811865476
    part, power = np.where(low, 2 * part, part), power - low
    t = (part - 1) / (part + 1)
    series = [2 / (2 * n + 1) for n in range(13)]
    return power * LN_2[0] + (power * LN_2[1] + t * _polynomial(series, t * t))


def edges(low: float, high: float, bins: int, *, logarithmic: bool) -> np.ndarray:
    """Return the inner edges of equal bins, to the last bit in single precision.

    `low` and `high` are the outer edges. Bins are equal in the logarithm if `logarithmic`.
    """
    # In decimals, since a logarithm rounds differently on each device.
    with localcontext(Context(prec=40)):
        first, last = (Decimal(repr(float(end))) for end in (low, high))
        shares = [Decimal(edge) / bins for edge in range(1, bins)]
        if logarithmic:
            inner = [first * (last / first) ** share for share in shares]
        else:
            inner = [first + (last - first) * share for share in shares]
    return np.array([float(edge) for edge in inner], np.float32)


def inverse(matrix: np.ndarray) -> np.ndarray:
    """Return the inverse of a symmetric positive definite matrix, without pivots."""
    count = len(matrix)
    # Gauss-Jordan: rows are reduced to the identity, beside which the inverse appears.
    rows = np.concatenate([matrix, np.eye(count)], 1)
    for row in range(count):
        used = slice(row, count + row + 1)  # Columns before are done, columns behind are empty.
        pivot = rows[row, used] / rows[row, row]
        factor = rows[:, row].copy()
        rows[:, used] -= factor[:, None] * pivot[None]
        rows[row, used] = pivot
    return rows[:, count:]


def eigenvectors(matrix: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the eigenvalues of a symmetric matrix, the largest first, and unit eigenvectors.

    Each row of the second result is an eigenvector. The method is cyclic rotations (Jacobi;
    Golub and Van Loan, Matrix Computations, section 8.5).
    """
    left, count = np.array(matrix, float), len(matrix)
    vectors, pairs = np.eye(count), [(p, q) for p in range(count) for q in range(p + 1, count)]
    # Below the last bit of the largest element: rotations beyond would change nothing.
    negligible = np.ldexp(np.max(np.abs(left), initial=0.0), -60)
    for _ in range(SWEEPS):
        turned = [_diagonalise(left, vectors, *pair, negligible) for pair in pairs]
        if not any(turned):
            break
    values = np.diagonal(left)
    order = np.argsort(-values, kind="stable")
    return values[order], vectors[order]


def _diagonalise(
    left: np.ndarray, vectors: np.ndarray, p: int, q: int, negligible: float
) -> bool:
    """Rotate the element (p, q) to 0, in place; return whether it was above `negligible`."""
    element = float(left[p, q])
    if abs(element) <= negligible:
        return False
    ratio = (float(left[q, q]) - float(left[p, p])) / (2 * element)
    # The smaller of the two angles that diagonalise: rotations then converge.
    tangent = 1 / (abs(ratio) + sqrt(ratio * ratio + 1))
    tangent = tangent if ratio >= 0 else -tangent
    c = 1 / sqrt(tangent * tangent + 1)
    s = tangent * c
    for rows in (left, left.T, vectors):
        one, other = rows[p].copy(), rows[q].copy()
        rows[p], rows[q] = c * one - s * other, s * one + c * other
    left[p, q] = left[q, p] = 0.0  # Rounding would leave a residue.
    return True


def _polynomial(coefficients: list[float], x: np.ndarray) -> np.ndarray:
    """Return a polynomial by Horner's rule, its constant first."""
    total = np.full_like(x, coefficients[-1])
    for coefficient in coefficients[-2::-1]:
        total = total * x + coefficient
    return total


def _of_quarter(x: np.ndarray | float, ahead: int) -> np.ndarray:
    """Return the sine of angles `ahead` by quarter turns."""
    rest = np.asarray(x, float)
    quarters = np.rint(rest * 0.6366197723675814)
    for part in QUARTER:
        rest = rest - quarters * part
    z = rest * rest
    s = rest * _polynomial([(-1) ** n / factorial(2 * n + 1) for n in range(10)], z)
    c = _polynomial([(-1) ** n / factorial(2 * n) for n in range(11)], z)
    quarter = quarters.astype(int) + ahead
    value = np.where(quarter & 1, c, s)
    return np.where(quarter & 2, -value, value)
