"""Database sessions, errors as problem details, and HTTP helpers for all packages."""
