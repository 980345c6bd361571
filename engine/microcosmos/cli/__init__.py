"""The command line: each module registers its commands. JAX is loaded only to compute."""

from . import (
    archive,
    cluster,
    compare,
    creature,
    doctor,
    draw,
    draw_groups,
    exporting,
    manage,
    modules,
    monitor,
    physical,
    pictures,
    reproject,
    run,
    sharing,
    study,
)
from .app import app
