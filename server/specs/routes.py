"""The route of experiments, from which the page builds its forms."""

from functools import cache

from fastapi import APIRouter

from microcosmos.spec import EXPERIMENTS

from ..auth.authorize import MAY_READ
from ..services.services import ServicesDep, SessionDep
from ..workers.plugins import KnownPlugins
from .plugin_schemas import with_plugins
from .schemas import ExperimentRead, PresetRead

router = APIRouter(prefix="/experiments", tags=["experiments"])


@router.get("", dependencies=[MAY_READ])
def list_experiments(services: ServicesDep, session: SessionDep) -> list[ExperimentRead]:
    """Return the experiments, with the plug-ins of live workers among the choices."""
    known = KnownPlugins(services, session)
    offered = known.offered()
    if not offered:
        return built_in()
    return [
        one.model_copy(
            update={"schema_": with_plugins(one.schema_, offered, known.workers_with)}
        )
        for one in built_in()
    ]


@cache
def built_in() -> list[ExperimentRead]:
    """Return the experiments without plug-ins; building their schemas takes 0.1 s."""
    return [
        ExperimentRead(
            experiment=name,
            title=experiment.title,
            schema_=experiment.spec.model_json_schema(),
            presets=[
                PresetRead(name=p.name, title=p.title, spec=p.spec.model_dump(mode="json"))
                for p in experiment.presets
            ],
        )
        for name, experiment in EXPERIMENTS.items()
    ]
