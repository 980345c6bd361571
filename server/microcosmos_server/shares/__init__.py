"""Shares: publishing, pages, and routes."""
