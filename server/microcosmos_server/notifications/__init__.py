"""Notifications: tell a webhook when a run ends, fails or pauses for a person."""
