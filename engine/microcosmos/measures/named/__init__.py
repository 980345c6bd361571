"""Measures that a spec names, one in each file; JAX is imported when they are computed."""
