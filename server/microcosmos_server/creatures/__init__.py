"""Creatures: storage, lineage, the import sandbox, and routes."""
