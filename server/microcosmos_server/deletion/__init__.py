"""Deletion: purge runs, collect garbage, and forget what the settings no longer keep."""
