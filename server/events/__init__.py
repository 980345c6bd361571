"""Events: a Redis stream, its fan-out to listeners, and the route."""
