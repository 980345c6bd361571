"""The command line: each module registers its commands. JAX is loaded only to compute."""

from . import (
    archive,
    cluster,
    creature,
    doctor,
    draw,
    exporting,
    manage,
    modules,
    monitor,
    pictures,
    reproject,
    run,
    sharing,
)
from .app import app
