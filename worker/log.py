"""What a worker's processes write down."""

import logging


def begin() -> None:
    """To standard error, with times; JAX's probing of devices left out."""
    logging.basicConfig(level=logging.INFO, format="%(asctime)s %(name)s: %(message)s")
    logging.getLogger("jax").setLevel(logging.WARNING)
