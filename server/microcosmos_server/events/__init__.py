"""Events: fan-out of the event stream to listeners, and the route."""
