"""Artifacts behind fsspec: checkpoints, renderings and shared archives."""
