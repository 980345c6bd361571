"""Services that server and workers share, created from settings."""
