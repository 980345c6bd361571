"""Creature files as people send them: JSON, or HDF5."""

import json
from typing import Any

from pydantic import ValidationError

from microcosmos.archive import creature_h5, pedigree
from microcosmos.archive.creature import CreatureError

from ..core import errors, uploads
from ..core.errors import ProblemError
from ..core.schemas import Problem

HDF5 = b"\x89HDF\r\n\x1a\n"


def creature_file(body: bytes) -> dict[str, Any]:
    """The creature file in some bytes, checked, with those of its `ancestors`, as few as
    there may be; `ProblemError` says why there is none."""
    if not body.startswith(HDF5):
        return pedigree.document(*pedigree.split(uploads.mapping(uploads.parse(body))))
    try:
        file = creature_h5.load(body)
    except CreatureError:
        raise
    except ValueError as error:
        raise ProblemError(422, "Not a creature file", f"{error}.") from error
    uploads.refuse_unkeepable(file)
    return pedigree.document(file, [])


def answer(body: bytes) -> bytes:
    """The file as JSON, or the problem with it: what goes back from where files are read."""
    try:
        return json.dumps({"file": creature_file(body)}).encode()
    except ProblemError as error:
        problem = error.problem
    except CreatureError as error:
        problem = errors.bad_creature(error)
    except ValidationError as error:
        problem = errors.invalid(error)
    except MemoryError:
        problem = _unreadable("reading it needs more memory than a creature file has a use for")
    except Exception as error:  # Whatever a library stumbles over is the file's fault.
        problem = _unreadable(f"{type(error).__name__}: {error}")
    return json.dumps({"problem": problem.model_dump(mode="json")}).encode()


def _unreadable(why: str) -> Problem:
    detail = f"The file cannot be read: {why:.300}."
    return Problem(title="Unreadable", status=422, detail=detail)
