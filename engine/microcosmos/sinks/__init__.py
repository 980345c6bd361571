"""Sinks: the curves, pictures and files of a run in TensorBoard, MLflow and W&B; JAX-free."""
