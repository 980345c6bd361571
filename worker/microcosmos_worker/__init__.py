"""The worker: computes queued runs, and makes renderings and audits of creatures."""
