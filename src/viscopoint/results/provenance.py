"""Where a result comes from: versions, machine, threads, times."""

import functools
import platform
import subprocess
import sys
from collections.abc import Iterable
from datetime import UTC, datetime
from importlib import metadata
from pathlib import Path
from typing import Any

import numba

from viscopoint.case.case import Case
from viscopoint.kernels import outside
from viscopoint.kernels.promise import promise
from viscopoint.kernels.sources import digest
from viscopoint.messages import one_line

# of run folders; 3: radii at the surface; 4: hypoelastic energy; 5: points of tlmpm cell by cell; 6: checksums;
# 7: contact radius, mass, losses; 8: a file for each snapshot
FORMAT, READABLE = 8, (5, 6, 7, 8)
PACKAGES = ("h5py", "pydantic")  # beside those on which bits depend


def provenance() -> dict[str, Any]:
    """Return what a run folder records about its making, at the start of a run."""
    words = [Path(sys.argv[0]).name, *sys.argv[1:]] if sys.argv and sys.argv[0] else []
    return {
        "format": FORMAT,
        "viscopoint": metadata.version("viscopoint"),
        "commit": _commit(),
        "sources": digest(),
        **promise(),
        **{name: metadata.version(name) for name in PACKAGES},
        "system": f"{platform.system()} {platform.release()}",
        "processor": _processor(),
        "threads": numba.get_num_threads(),
        "command": [one_line(word) for word in words],
        "started": now(),
        "ended": None,
        "resumed": [],
    }


def of_resuming(earlier: dict[str, Any], changed: Iterable[str]) -> dict[str, Any]:
    """Return what changes when a run is resumed where so much is not as it was (``promise.differences``)."""
    return {
        "ended": None,
        "resumed": [*earlier.get("resumed", []), now()],
        "resumed_with": list(dict.fromkeys([*earlier.get("resumed_with", []), *changed])),
    }


def now() -> str:
    """Return the time of day, in UTC."""
    return datetime.now(UTC).isoformat(timespec="seconds")


@functools.cache
def _commit() -> str | None:
    """Return the commit of the package's own checkout, with a "+" if it was changed; None if installed otherwise."""
    package = Path(__file__).parents[1]
    top = package.parent.parent
    if not (top / ".git").exists():
        return None

    def git(*words: str) -> str:
        return subprocess.run(["git", "-C", top, *words], capture_output=True, text=True, check=True, timeout=10).stdout

    try:
        changed = git("status", "--porcelain", "--", str(package))
        return git("rev-parse", "HEAD").strip() + ("+" if changed else "")
    except (OSError, subprocess.SubprocessError):
        return None


@functools.cache
def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
        return next(line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
    except (OSError, StopIteration):
        return platform.processor()


def sources_of(case: Case) -> str:
    """Return a hash of all sources that compute and write the results of a case, laws of users included."""
    others = outside.hashed((type(case.material), type(case.material.build()), type(case.method)))
    return f"{digest()}+{others}" if others else digest()
