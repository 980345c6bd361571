"""The reference of every field of a spec: `python -m microcosmos.spec.reference`."""
