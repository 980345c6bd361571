"""The spec in the body of a request."""

from typing import Annotated

from fastapi import Body, Depends

from microcosmos.spec import Spec

from ..services.services import ServicesDep
from . import parsing
from .schemas import SpecDocument

SPEC_BYTES = 1 << 20
"""The largest body of a request that contains a spec."""


def spec_sent(document: Annotated[SpecDocument, Body()], services: ServicesDep) -> Spec:
    return parsing.parse(services, document)


SpecDep = Annotated[Spec, Depends(spec_sent)]
