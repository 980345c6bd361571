"""What a machine lacks."""
