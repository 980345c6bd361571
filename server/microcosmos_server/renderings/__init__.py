"""Renderings of creatures: replays, films, pictures, audits and measurements."""
