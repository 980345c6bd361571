"""The application's server: HTTP, database, queue and events; no JAX in here."""
