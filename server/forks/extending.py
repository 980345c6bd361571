"""Extend a finished run: the result is the same as with all generations from the start."""

from sqlalchemy.orm import Session

from microcosmos.spec import Evolution, Spec, parse

from ..core.database import clock
from ..core.errors import FieldError, ProblemError
from ..runs.lifecycle import NOT_IN_BIN, change, refuse
from ..runs.log import note
from ..tables import FINISHED, QUEUED, Run


def longer(run: Run, more: int) -> Spec:
    """Return the spec with more generations; raise `ProblemError` if that is impossible."""
    if "generations" not in run.spec.get("search", {}):
        detail = (
            f"A run of `{run.experiment}` is complete at its end: only searches, which have "
            "`search.generations`, can be extended."
        )
        error = FieldError(field="search.generations", message=detail, got=run.experiment)
        raise ProblemError(409, "Not extensible", detail, [error])
    if run.status == FINISHED and (ended := (run.summary or {}).get("ended")):
        detail = (
            f"`search.stop` ended the run ({ended}) and would end a longer one at the same "
            "generation. Fork the run with another `search.stop`."
        )
        raise ProblemError(409, "More generations have no effect", detail)
    search = {**run.spec["search"], "generations": run.generations + more}
    spec = parse({**run.spec, "search": search})
    assert isinstance(spec, Evolution)
    return spec


def extend(session: Session, run: Run, spec: Spec) -> Run:
    """Queue a run again, to continue from its last checkpoint."""
    # The second of two concurrent extensions would set a wrong total.
    unchanged = (NOT_IN_BIN, Run.status == FINISHED, Run.generations == run.generations)
    changed = change(
        session,
        run.id,
        *unchanged,
        status=QUEUED,
        spec=spec.model_dump(mode="json"),
        generations=spec.generations,
        finished_at=None,
        queued_at=clock(),
        attempts_without_checkpoint=0,
    )
    if changed is None:
        refuse(session, "extend", run, "finished")
    more = spec.generations - run.generations
    plural = "s" if more > 1 else ""
    text = f"Extended by {more} generation{plural} to {spec.generations}: queued again."
    note(session, changed, text)
    return changed
