"""Runs: lifecycle, submission, listing, curves, log, and routes."""
