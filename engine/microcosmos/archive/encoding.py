"""Numbers and names as they stand in creature files."""

from base64 import b64decode, b64encode

import numpy as np

ACTIVATIONS = (
    "identity",
    "sigmoid",
    "tanh",
    "relu",
    "sin",
    "cos",
    "gaussian",
    "abs",
    "square",
)
"""In the order of the numbers that genomes hold."""


def encode(values: np.ndarray) -> str:
    """Little-endian float32 as base64, −0 as 0."""
    return b64encode((np.asarray(values, "<f4") + np.float32(0)).tobytes()).decode()


def decode(text: str) -> np.ndarray:
    """The float32 values in base64; raises `ValueError` where they are none or not finite."""
    data = b64decode(text, validate=True)
    if len(data) % 4:
        raise ValueError(f"needs whole float32 values, got {len(data)} bytes")
    values = np.frombuffer(data, "<f4")
    if not np.all(np.isfinite(values)):
        raise ValueError("needs finite values, got NaN or infinity")
    if encode(values) != text:
        raise ValueError("needs the canonical encoding, got another (−0 is written as 0)")
    return values
