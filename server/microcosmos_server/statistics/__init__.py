"""Statistics of finished runs: groups that differ in the seed alone, compared by rank tests."""
