"""Periodic work, health and metrics."""
