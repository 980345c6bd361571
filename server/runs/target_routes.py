"""The pictures that the filaments of a run fold into."""

from fastapi import APIRouter

from microcosmos.spec import Folding, parse, targets

from ..auth.authorize import MAY_READ
from ..core.errors import ProblemError
from .deps import RunDep
from .schemas import Target

router = APIRouter(prefix="/runs/{run_id}/targets", tags=["results"])


@router.get("", dependencies=[MAY_READ])
def read_targets(run: RunDep) -> list[Target]:
    """In the order of the spec; at most 256 pixels along a side."""
    if run.experiment != "folding":
        detail = f"A run of `{run.experiment}` folds nothing into pictures."
        raise ProblemError(404, "No pictures", detail)
    chosen = parse(run.spec)
    assert isinstance(chosen, Folding)
    longest = min(chosen.size, targets.MOST)
    fitted = [(one.name, targets.fitted(one.ink, longest)) for one in chosen.targets]
    return [
        Target(
            name=name,
            width=ink.shape[1],
            height=ink.shape[0],
            size=chosen.size,
            pixels=targets.encoded(ink),
        )
        for name, ink in fitted
    ]
