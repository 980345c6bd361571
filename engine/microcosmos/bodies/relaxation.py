"""The slowest bend of a body whose joints are swept, from its graph and its stiffness."""

from typing import Any

import numpy as np
from scipy import sparse
from scipy.sparse import linalg

from .graph import Body
from .layout import pieces

DENSE = 200
"""Most edges for which all modes are computed; of larger bodies only the slowest are."""
BESIDE = 1e-9
"""Distance from 1 at which the slowest modes of a large body are sought."""


def relaxation(body: Body, bend: np.ndarray) -> float:
    """Return the sweeps over its joints in which the slowest bend of a body falls to 1/e.

    `bend` (joint,) is the stiffness of each joint, from 0 to 1.

    A sweep takes the colours of joints in order: each joint turns both of its edges by half of
    its stiffness times its error. So a sweep multiplies the angles of edges, less those of a
    shape without errors, by one matrix. Its eigenvalue 1 is the turn of a whole piece; the
    largest one below is the slowest bend. It is 0 without joints, or where one sweep removes
    all errors, and infinite where a joint has no stiffness.
    """
    if not len(body.joints):
        return 0.0
    if np.min(bend) <= 0:
        return np.inf
    turns = int(pieces(body.joints, len(body.edges)).max()) + 1
    found = np.sort(np.abs(_modes(_sweep(body, bend), turns)))[::-1]
    slowest = found[turns] if len(found) > turns else 0.0
    return 0.0 if slowest < 1e-12 else float(-1 / np.log(slowest))


def _sweep(body: Body, bend: np.ndarray) -> Any:
    """Return the sparse matrix (edge, edge) by which a sweep multiplies the angles of edges."""
    count = len(body.edges)
    whole: Any = sparse.eye_array(count, format="csr")
    for colour in body.joint_colours:
        edge = np.flatnonzero(colour.sign)
        half = 0.5 * bend[colour.constraint[edge]]
        rows, columns = np.tile(edge, 2), np.concatenate([edge, colour.partner[edge]])
        turned = sparse.csr_array(
            (np.concatenate([-half, half]), (rows, columns)), shape=(count, count)
        )
        whole = whole + turned @ whole
    return whole


def _modes(matrix: Any, turns: int) -> np.ndarray:
    """Return all eigenvalues, or of a large matrix those nearest to 1."""
    count = matrix.shape[0]
    if count <= max(DENSE, turns + 3):
        return np.linalg.eigvals(matrix.toarray())
    first = np.random.default_rng(0).standard_normal(count)  # Else it is drawn each time.
    given: dict[str, Any] = {"sigma": 1 + BESIDE, "v0": first, "return_eigenvectors": False}
    found: Any = linalg.eigs(matrix.tocsc(), k=turns + 1, **given)
    return found
