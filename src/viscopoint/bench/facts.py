"""What machine and software a benchmark was made on."""

import os
from pathlib import Path
from typing import Any

import numba

from viscopoint.model import memory
from viscopoint.results.provenance import provenance

OF_A_RUN = ("format", "threads", "command", "started", "ended")  # of provenance: not of the machine
CACHES = Path("/sys/devices/system/cpu/cpu0/cache")
UNITS = {"K": 2**10, "M": 2**20, "G": 2**30}


def facts() -> dict[str, Any]:
    """Return versions, processor, caches, memory and how busy the machine is."""
    known = {name: value for name, value in provenance().items() if name not in OF_A_RUN}
    return known | {
        "cores": os.cpu_count(),
        "threads": numba.get_num_threads(),
        "caches [bytes]": caches(),
        "memory [bytes]": int(memory.machine()),
        "load": round(os.getloadavg()[0], 2),  # programs that ran in the last minute, on average
    }


def caches() -> dict[str, int]:
    """Return the sizes of the first core's data caches by name, such as "L1"; none where the system does not tell."""
    found = {}
    for index in sorted(CACHES.glob("index*")):
        try:
            level, kind, size = ((index / name).read_text().strip() for name in ("level", "type", "size"))
            if kind != "Instruction":
                found[f"L{level}"] = int(size[:-1]) * UNITS[size[-1]]
        except (OSError, ValueError, KeyError, IndexError):
            continue
    return found


def last_cache() -> int:
    """Return the size of the last cache before memory [bytes], 0 where it is not known."""
    return max(caches().values(), default=0)
