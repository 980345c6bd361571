"""Forking and extending runs."""
