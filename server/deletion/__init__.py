"""Deletion: the bin, purging, and garbage collection."""
