"""Files of archives and creatures, and reports of a generation; JAX-free."""
