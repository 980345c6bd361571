"""Artifacts behind fsspec: checkpoints and renderings."""
