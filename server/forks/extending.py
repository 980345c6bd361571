"""More generations for a finished run: it goes on as if it had had them from the start."""

from typing import Any

from sqlalchemy.orm import Session

from microcosmos.spec import Evolution, Spec, parse

from ..core.database import clock
from ..core.errors import FieldError, ProblemError
from ..runs.lifecycle import KEPT, change, refuse
from ..runs.log import note
from ..tables import FINISHED, QUEUED, Run


def longer(run: Run, more: int) -> Spec:
    """Return the spec with more generations; raise `ProblemError` where that cannot be."""
    _refuse_without_generations(run)
    if run.status == FINISHED and (ended := (run.summary or {}).get("ended")):
        detail = (
            f"`search.stop` ended the run ({ended}), as it would end a longer one; fork it "
            "with another `search.stop`."
        )
        raise ProblemError(409, "It would change nothing", detail)
    search = {**run.spec["search"], "generations": run.generations + more}
    spec = parse({**run.spec, "search": search})
    assert isinstance(spec, Evolution)
    return spec


def extend(session: Session, run: Run, spec: Spec) -> Run:
    """Back into the queue, to go on from its last checkpoint."""
    more = spec.generations - run.generations
    # Of two that extend it at once, one would not know how long it is.
    same = (KEPT, Run.status == FINISHED, Run.generations == run.generations)
    changed = change(session, run.id, *same, **_again(spec))
    if changed is None:
        refuse(session, "extend", run, "finished")
    plural = "s" if more > 1 else ""
    text = f"Extended by {more} generation{plural} to {spec.generations}: queued again."
    note(session, changed, text)
    return changed


def _again(spec: Spec) -> dict[str, Any]:
    return {
        "status": QUEUED,
        "spec": spec.model_dump(mode="json"),
        "generations": spec.generations,
        "finished_at": None,
        "queued_at": clock(),
        "attempts_without_checkpoint": 0,
    }


def _refuse_without_generations(run: Run) -> None:
    if "generations" in run.spec.get("search", {}):
        return
    detail = (
        f"A run of `{run.experiment}` is complete when it ends: only searches, which have "
        "`search.generations`, can be extended."
    )
    error = FieldError(field="search.generations", message=detail, got=run.experiment)
    raise ProblemError(409, "Not to be extended", detail, [error])
