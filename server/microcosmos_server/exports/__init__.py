"""Exports of runs: tables, datasets, phylogenies and RO-Crates for other programs."""
