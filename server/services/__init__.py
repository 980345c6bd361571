"""Services that server and workers share, put together from settings."""
