"""The API: one router for each noun."""

from fastapi import APIRouter

from . import archives, creatures, events, experiments, generations, replays, runs, workers

api = APIRouter(prefix="/api/v1")
for noun in (experiments, runs, generations, archives, creatures, replays, events, workers):
    api.include_router(noun.router)
