"""The API: one router for each noun."""

from fastapi import APIRouter

from ..description import PROBLEMS
from . import (
    archives,
    creatures,
    events,
    experiments,
    generations,
    journal,
    measurements,
    networks,
    queue,
    renderings,
    results,
    runs,
    shared,
    shared_archives,
    shares,
    tags,
    targets,
    workers,
)

api = APIRouter(prefix="/api/v1", responses=PROBLEMS)
for noun in (
    experiments,
    runs,
    generations,
    journal,
    archives,
    results,
    targets,
    creatures,
    networks,
    renderings,
    measurements,
    shares,
    shared,
    shared_archives,
    events,
    workers,
    queue,
    tags,
):
    api.include_router(noun.router)
