"""The small run that a new data folder begins with, so that there is something to watch."""

from sqlalchemy import exists, select

from microcosmos.spec import EXPERIMENTS

from ..runs.submission import submit
from ..services.services import Services
from ..tables import Run

EXPERIMENT, PRESET = "quality-diversity", "demo"


def offer(services: Services) -> None:
    """Submit it where there has never been a run."""
    with services.sessions.read() as session:
        begun = session.scalar(select(exists().select_from(Run)))
    if not begun:
        presets = {preset.name: preset.spec for preset in EXPERIMENTS[EXPERIMENT].presets}
        submit(services, presets[PRESET], demonstration=True)
