"""Exports of runs for other programs: tables, datasets, phylogenies, RO-Crates; JAX-free."""
