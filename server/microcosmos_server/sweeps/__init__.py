"""Sweeps: grid, submission, summary, and routes."""
