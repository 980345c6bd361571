"""The engine against theory and literature; `python -m validation` writes the document."""
