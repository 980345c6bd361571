"""Rollouts on GPUs: one program of a whole rollout for each world."""

from .simulation import chosen, rollout, uncovered
