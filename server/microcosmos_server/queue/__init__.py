"""Queue: RQ jobs, and how they are enqueued."""
