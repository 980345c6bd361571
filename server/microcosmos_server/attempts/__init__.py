"""Attempts: claims, leases, checkpoints, and recording what a worker reports."""
