"""Phylogenies: the tree of a run or of a creature, across forks."""
