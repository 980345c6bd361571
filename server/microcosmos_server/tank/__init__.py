"""The tank: creatures of the latest runs that swim on the first page."""
