"""The schedule: SQL decides which queued run a worker gets; Redis only wakes idle workers."""
