"""One run over many hosts: helpers compute its blocks, which a Dask scheduler brings to them.

A block travels as its spec, the name of a program and arrays. The place of its computation
changes no bit, since only helpers of the run's kind of device compute.
"""

from .devices import ClusterDevices, over
from .dispatch import Disagreement
from .scheduler import DEFAULT_PORT, security, write_certificate
