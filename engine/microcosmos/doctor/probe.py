"""Print JAX's abilities as JSON; a process of its own, since a broken driver may hang it."""

import ctypes
import json
import sys
import tempfile
from importlib import import_module
from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from ..device import device_kind, kernel, kernel_version, prepare

HIT = "/jax/compilation_cache/cache_hits"


def main(cache: Path) -> None:
    try:
        prepare()
        if kernel_version():
            ctypes.CDLL(str(import_module("microcosmos_kernels").library()))
    except (ValueError, OSError) as error:  # A wrong variable, or a library that is damaged.
        print(json.dumps({"refused": str(error)}))
        return
    abilities = {
        "kind": device_kind(),
        "kernel": {"chosen": kernel(), "version": kernel_version()},
        "devices": [_device(one) for one in jax.local_devices()],
    }
    print(json.dumps(abilities | {"cache": _cache(cache)}))


def _device(device: Any) -> dict[str, Any]:
    """Return the result of a small computation, and the memory of a device."""
    record = {"platform": device.platform, "model": device.device_kind, "id": device.id}
    numbers = np.arange(64, dtype=np.float32)
    try:
        computed = float(jax.jit(lambda x: jnp.sum(x * x))(jax.device_put(numbers, device)))
    except Exception as error:  # Whatever a driver throws has to be reported.
        return record | {"error": f"{type(error).__name__}: {error}"[:300]}
    memory = device.memory_stats() or {}
    return record | {
        "correct": computed == float(numbers @ numbers),
        "memory_bytes": memory.get("bytes_limit"),
        "memory_used_bytes": memory.get("bytes_in_use"),
    }


def _cache(folder: Path) -> dict[str, Any]:
    """Compile a program twice; return whether it was stored, and loaded again."""
    events: list[str] = []
    jax.monitoring.register_event_listener(lambda event, **_: events.append(event))
    with tempfile.TemporaryDirectory(prefix="doctor-", dir=folder) as place:
        jax.config.update("jax_compilation_cache_dir", place)
        # The second time, the program has to come from the folder.
        for _ in range(2):
            jax.clear_caches()
            jax.block_until_ready(jax.jit(lambda x: jnp.cos(x) + 1)(jnp.arange(7.0)))
        return {"stored": bool(list(Path(place).iterdir())), "loaded": HIT in events}


if __name__ == "__main__":
    main(Path(sys.argv[1]))
