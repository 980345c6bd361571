"""Which queued run a worker carries out next. SQL decides; Redis only wakes idle workers."""
