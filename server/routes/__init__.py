"""The API: one router for each noun."""

from fastapi import APIRouter

from ..description import PROBLEMS
from . import (
    archives,
    creatures,
    events,
    experiments,
    generations,
    networks,
    renderings,
    results,
    runs,
    workers,
)

api = APIRouter(prefix="/api/v1", responses=PROBLEMS)
for noun in (
    experiments,
    runs,
    generations,
    archives,
    results,
    creatures,
    networks,
    renderings,
    events,
    workers,
):
    api.include_router(noun.router)
