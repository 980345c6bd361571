"""A genome with genes that are no number, or infinite, is reported as non-finite."""

from dataclasses import replace
from functools import partial

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from genotypes import any_genotype

from microcosmos import device, search, spec
from microcosmos.build import build_task

ENCODINGS = ("cppn", "direct")
BAD = np.float32([np.nan, np.inf, -np.inf])


@pytest.mark.long
@pytest.mark.parametrize("kernel", ["jax", "native"])
@pytest.mark.parametrize("encoding", ENCODINGS)
def test_every_gene_that_is_not_finite_is_reported(encoding, kernel, monkeypatch):
    if kernel == "native":
        pytest.importorskip(
            "microcosmos_kernels", reason="microcosmos-kernels is not installed"
        )
    monkeypatch.setenv(device.KERNEL_VARIABLE, kernel)
    scene = spec.Scene.model_validate(
        {
            "world": {"width": 24, "height": 24},
            "body": {"nodes": 6},
            "control": {"encoding": encoding, "period": 20, "length_scale": 0.05},
            "task": {"steps": 20, "fitness": "displacement"},
        }
    )
    task = build_task(scene)
    sound = any_genotype(scene, task.encoding, np.random.default_rng(0))
    block = stacked([sound, *harmed(sound)])
    found = search.block_program(partial(search.evaluate, task))(block)
    names = [search.STATUSES[code] for code in np.asarray(found.status)]
    assert names == ["ok"] + ["non-finite"] * (len(names) - 1)


def harmed(genotype):
    """Yield genotypes of which one gene in use is not finite."""
    for name in ("values", "bias", "weight"):
        genes = getattr(genotype, name, None)
        if genes is None:
            continue
        used = {"bias": "node_used", "weight": "connection_used"}.get(name)
        places = range(len(genes)) if used is None else np.flatnonzero(getattr(genotype, used))
        for place in places:
            for bad in BAD:
                yield replace(genotype, **{name: genes.at[place].set(bad)})


def stacked(genotypes):
    return jax.tree.map(lambda *rows: jnp.stack(rows), *genotypes)
