"""Estimates: time, memory, and position in the queue."""
