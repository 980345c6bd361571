"""Specs: parsing with plug-ins, and schemas and presets for the page."""
