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
    session,
    shared,
    shared_archives,
    shares,
    sweeps,
    tags,
    targets,
    tokens,
    workers,
)

api = APIRouter(prefix="/api/v1", responses=PROBLEMS)
for noun in (
    experiments,
    runs,
    sweeps,
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
    tokens,
    session,
):
    api.include_router(noun.router)
