"""Files that outlive a run: archives and creatures; JAX-free."""
