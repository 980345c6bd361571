"""Archives: queries and routes."""
