"""The command line: each module registers its commands. JAX is loaded only to compute."""

from . import (
    cluster,
    creature,
    doctor,
    draw,
    exporting,
    groups,
    manage,
    pictures,
    reproject,
    run,
    sharing,
    study,
)
from .app import app
