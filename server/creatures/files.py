"""Read creature files as people send them: JSON or HDF5."""

from typing import Any

from microcosmos.archive import creature_h5, pedigree
from microcosmos.archive.creature import CreatureError

from ..core import json_body
from ..core.errors import ProblemError

HDF5 = b"\x89HDF\r\n\x1a\n"


def creature_file(body: bytes) -> dict[str, Any]:
    """Return the checked creature file, with the files of its `ancestors`."""
    if not body.startswith(HDF5):
        return pedigree.document(*pedigree.split(json_body.mapping(json_body.parse(body))))
    try:
        file = creature_h5.load(body)
    except CreatureError:
        raise
    except ValueError as error:
        raise ProblemError(422, "Not a creature file", f"{error}.") from error
    json_body.refuse_unstorable(file)
    return pedigree.document(file, [])
