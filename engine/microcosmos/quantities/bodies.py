"""Bodies of creatures from their genes in NumPy, and how slowly they bend."""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from math import isfinite, log1p
from typing import Any

import numpy as np

# Imported with the module: later the server's sandbox may open no file.
from scipy import sparse
from scipy.sparse import linalg

from .. import units
from ..bodies import Body, extent, growth, is_exact
from ..bodies.layout import pieces
from ..naming import decode, decoded
from ..spec import BodyGraph, Direct, GrownBody, Scene, shape

Genes = Mapping[str, Any]
"""The genome of a creature's identity."""
SEGMENT = "segment_"
"""Prefix of the columns of a plan in an archive file."""


def body_of(scene: Scene, genes: Genes) -> Body:
    """Return the graph of a creature, with the rest lengths and stiffness that it inherits."""
    control, whole = scene.control, scene.body
    if isinstance(control, BodyGraph) and isinstance(whole, GrownBody):
        return growth.grown_body(_plan(genes, whole), whole.capacity, control.softest)
    if isinstance(control, Direct):
        return _inherited(control, shape(whole), decode(genes["values"]))
    return shape(whole)


def length_of(scene: Scene, genes: Genes) -> float:
    """Return the reach of a creature's body: the longest path along its edges, in cells."""
    if isinstance(scene.body, GrownBody):
        return growth.grown_length(_plan(genes, scene.body), scene.body.capacity)
    return extent(body_of(scene, genes))


def elites(scene: Scene, genomes: Mapping[str, np.ndarray]) -> Iterator[Body]:
    """Yield the body of each elite of an archive file from its `archive/genomes`."""
    count = len(next(iter(genomes.values())))
    control, whole = scene.control, shape(scene.body)
    for row in range(count):
        genes = {name: values[row] for name, values in genomes.items()}
        if isinstance(control, BodyGraph) and isinstance(scene.body, GrownBody):
            fields = growth.Plan._fields
            plan = growth.Plan(**{name: genes[SEGMENT + name] for name in fields})
            yield growth.grown_body(plan, scene.body.capacity, control.softest)
        elif isinstance(control, Direct):
            yield _inherited(control, whole, genes["values"])
        else:
            yield whole


def _plan(genes: Genes, body: GrownBody) -> growth.Plan:
    return growth.plan_of(decoded(genes["plan"]), body.segments)


def _inherited(control: Direct, body: Body, values: np.ndarray) -> Body:
    """Return the body with what its genes say, whose traits come first."""
    parts, found, used = control.parts(body), {}, 0
    for name, (low, high) in control.traits.items():
        genes = values[used : used + parts[name]].astype(float)
        found[name] = low + (high - low) * 0.5 * (1 + genes)
        used += parts[name]
    own = {name: found[name] for name in ("stretch", "shear", "bend") if name in found}
    if "rest_length" in found:
        own["rest_length"] = body.rest_length * found["rest_length"]
    return replace(body, **own)


def sperm(scene: Scene, body: Body, steps: float) -> float | None:
    """Return the effective sperm number of a body at rest in its scene, whose stroke takes so
    many steps; see `units.sperm`.

    The body follows a command within its relaxation time: the longer one of its actuators and
    of its slowest bend. Return None where a bend never relaxes, or the steps are unknown.
    """
    slowest = max(_response(getattr(scene.control, "lag", 0.0)), _bend(scene, body))
    return units.sperm(steps, slowest) if isfinite(slowest) and isfinite(steps) else None


def _response(lag: float) -> float:
    """Return the steps in which the actuators' error falls to 1/e: a step leaves the share
    lag / (1 + lag) of it."""
    return 1 / log1p(1 / lag) if lag else 0.0


def _bend(scene: Scene, body: Body) -> float:
    """Return the steps in which the slowest bend falls to 1/e.

    Where a plan grew the body, a step leaves the share 1 − `bend` of each joint's error. Any
    other body has its rest shape at once, or is swept `constraint_iterations` times a step.
    """
    form, stiffness = scene.coupling, body.bend
    if isinstance(scene.body, GrownBody):
        softest = float(np.min(stiffness, initial=1.0))
        return 0.0 if softest == 1 else -1 / log1p(-softest)
    traits = getattr(scene.control, "traits", {})
    inherited = {"stretch", "shear", "bend"} & set(traits)
    if not inherited and is_exact(body, form.theta_feedback, form.nu_c):
        return 0.0
    if form.nu_c is not None:
        stiffness = stiffness / (1 + scene.world.viscosity / form.nu_c)
    return relaxation(body, stiffness) / form.constraint_iterations


DENSE = 200
"""Most edges for which all modes are computed; larger bodies have only their slowest."""
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
    # The largest eigenvalues, all 1, are turns of whole pieces; the next is the slowest bend.
    sizes = np.sort(np.abs(_modes(_sweep(body, bend), turns)))[::-1]
    slowest = sizes[turns] if len(sizes) > turns else 0.0
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
    # ARPACK would draw its start vector anew in each call, and results would differ.
    first = np.random.default_rng(0).standard_normal(count)
    # At 1 itself, an eigenvalue, the shifted matrix could not be factorised.
    given: dict[str, Any] = {"sigma": 1 + BESIDE, "v0": first, "return_eigenvectors": False}
    modes: Any = linalg.eigs(matrix.tocsc(), k=turns + 1, **given)
    return modes
