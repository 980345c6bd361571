"""A creature's network as a picture, a graph, code, or a genome of another library."""

from collections.abc import Callable
from typing import Any

from fastapi import APIRouter
from fastapi.responses import Response

from ..auth.authorize import MAY_READ_SHARED
from . import networks
from .deps import IdentityDep
from .routes import FOR_EVER
from .sandbox import sandbox

router = APIRouter(prefix="/creatures/{sha}", tags=["creatures"])
WORDS = {
    "svg": "The network as a picture.",
    "dot": "The network for Graphviz.",
    "py": "The network as a Python module that needs NumPy alone.",
    "npz": "The network as a genome of TensorNEAT.",
}


def _reader(form: str, media_type: str) -> Callable[..., Response]:
    def read(identity: IdentityDep) -> Response:
        name = f"network-{identity.sha256[:12]}.{form}"
        headers = {
            "Cache-Control": FOR_EVER,
            "Content-Disposition": f'inline; filename="{name}"',
            "Content-Security-Policy": "default-src 'none'; style-src 'unsafe-inline'",
        }
        return Response(
            sandbox().network(identity.json, form), headers=headers, media_type=media_type
        )

    read.__name__ = f"read_network_{form}"
    read.__doc__ = WORDS[form]
    return read


for form, (media_type, _) in networks.FORMS.items():
    answers: dict[int | str, dict[str, Any]] = {200: {"content": {media_type: {}}}, 404: {}}
    route = router.get(
        f"/network.{form}",
        response_class=Response,
        responses=answers,
        dependencies=[MAY_READ_SHARED],
    )
    route(_reader(form, media_type))
