"""The ground of the server: database sessions, errors as problem details, HTTP helpers."""
