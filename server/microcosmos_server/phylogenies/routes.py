"""Routes of phylogenies: columns in bytes, ALife standard CSV and Newick."""

from collections.abc import Awaitable, Callable
from dataclasses import dataclass
from typing import Annotated, Any
from uuid import UUID

from fastapi import APIRouter, Depends, Query, Request
from fastapi.concurrency import run_in_threadpool
from fastapi.responses import Response

from microcosmos.archive import columns
from microcosmos.archive.phylogeny import Birth, Phylogeny, alife_csv, newick
from microcosmos.version import VERSION

from ..archives import elites
from ..archives.archive_of_request import refuse_table
from ..auth.authorize import MAY_READ, MAY_READ_SHARED, ShareAccessDep
from ..core.answers import respond, tag_of
from ..core.api import named, sends
from ..creatures.deps import Sha, find_creature
from ..runs.deps import find_run
from ..services.services import ServicesDep
from ..tables import Run
from . import births
from .births import arranged, of_run

router = APIRouter(tags=["phylogenies"])


@dataclass(frozen=True)
class Form:
    """A form of the answer."""

    ending: str
    media_type: str
    description: str
    write: Callable[[Phylogeny], bytes]


def _columns(found: Phylogeny) -> bytes:
    return columns.dump({"runs": found.runs, "operators": found.operators}, found.columns)


FORMS = (
    Form("", columns.MEDIA_TYPE, "columns in bytes", _columns),
    Form(
        ".csv",
        "text/csv",
        "a table in the ALife phylogeny standard",
        lambda found: alife_csv(found).encode(),
    ),
    Form(
        ".nwk",
        "text/plain",
        "Newick trees by first parents, one for each first ancestor",
        lambda found: newick(found).encode(),
    ),
)


@dataclass(frozen=True)
class RunTree:
    """The tree of a run in the state of one moment."""

    run: Run
    generation: int
    """The last one whose creatures it has."""
    ancestors: list[Birth]
    """Initial creatures and their ancestors: they may be deleted, or imported later."""


def _run_tree(
    run_id: UUID,
    services: ServicesDep,
    generation: Annotated[int | None, Query(ge=0)] = None,
) -> RunTree:
    """Find a run over a connection that is closed again: answers may take seconds."""
    with services.sessions.read() as session:
        run = find_run(session, run_id)
        refuse_table(run)
        last = elites.generation_of(run, generation)
        return RunTree(run, last, births.ancestors_of_run(session, run, last))


RunTreeDep = Annotated[RunTree, Depends(_run_tree)]


def _headers(form: Form, name: str) -> dict[str, str]:
    return named(f"phylogeny-{name}{form.ending}") if form.ending else {}


def _run_reader(form: Form) -> Callable[..., Awaitable[Response]]:
    async def read(request: Request, tree: RunTreeDep, services: ServicesDep) -> Response:
        run, last, above = tree.run, tree.generation, tree.ancestors

        def make() -> bytes:
            with services.sessions.read() as session:
                return form.write(of_run(session, run, above, last))

        tag = await run_in_threadpool(
            tag_of, VERSION, form.ending, run.id, run.rewinds, last, above
        )
        headers = _headers(form, str(run.id)[:8])
        return await respond(request, tag, make, form.media_type, headers)

    return read


def _creature_reader(form: Form) -> Callable[..., Awaitable[Response]]:
    async def read(
        request: Request, sha: Sha, share: ShareAccessDep, services: ServicesDep
    ) -> Response:
        def make() -> tuple[bytes, str]:
            with services.sessions.read() as session:
                row = find_creature(session, sha, share)
                tree = births.shared(session, row) if share else births.relatives(session, sha)
                content = form.write(arranged(session, tree))
            # Any run may add a descendant, so the bytes themselves are the tag.
            return content, tag_of(content)

        content, tag = await run_in_threadpool(make)
        headers = _headers(form, sha[:12])
        return await respond(request, tag, lambda: content, form.media_type, headers)

    return read


OTHERS: dict[int | str, dict[str, Any]] = {304: {"description": "Unchanged"}, 404: {}}

for form in FORMS:
    answers, suffix = sends(form.media_type, OTHERS), form.ending.replace(".", "_")
    router.get(
        f"/runs/{{run_id}}/phylogeny{form.ending}",
        **answers,
        name=f"read_run_phylogeny{suffix}",
        description="Return all creatures that ever entered the archive of a run, now or as of "
        f"a generation, and their ancestors in other runs, as {form.description}.",
        dependencies=[MAY_READ],
    )(_run_reader(form))
    router.get(
        f"/creatures/{{sha}}/phylogeny{form.ending}",
        **answers,
        name=f"read_creature_phylogeny{suffix}",
        description="Return a creature with all its ancestors and descendants, of any runs, as "
        f"{form.description}. A share shows ancestors alone.",
        dependencies=[MAY_READ_SHARED],
    )(_creature_reader(form))
