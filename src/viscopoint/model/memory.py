"""How much memory there is, and whether a run will fit into it."""

import sys
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from viscopoint.errors import InputError

GROUPS = Path("/sys/fs/cgroup")  # of processes that Linux keeps within limits, such as those of a container
MEMBERSHIP = Path("/proc/self/cgroup")


class Need(NamedTuple):
    """What a run takes when it takes most, by a generous estimate."""

    key: str  # of the case, whose value makes it so much
    what: str  # that value, and how many points or elements it gives
    size: float  # bytes
    advice: str = "take a larger one"


def machine() -> float:
    """Return the memory that processes here can ever have [bytes]: the machine's, less where a limit is set."""
    import psutil

    return min([psutil.virtual_memory().total, *(limit for limit, _ in _limits())])


def free() -> float:
    """Return the memory that this process can still take [bytes]."""
    import psutil

    return min([psutil.virtual_memory().available, *(limit - used for limit, used in _limits())])


def check(need: Need, there: float) -> None:
    """Refuse what does not fit into the memory that is there [bytes].

    Raises:
        InputError: it does not; the message names the key, the estimate and what is there.
    """
    if need.size > there:
        raise InputError(
            f"{need.key}: {need.what}, about {need.size / 2**30:.3g} GiB; there are {there / 2**30:.3g}: {need.advice}"
        )


def _limits() -> Iterator[tuple[float, float]]:
    """Yield the limits on this process, and what already counts towards each [bytes]."""
    yield from _address_space()
    yield from _group_limits()


def _address_space() -> Iterator[tuple[float, float]]:
    if sys.platform == "win32":
        return
    import resource

    import psutil

    limit, _ = resource.getrlimit(resource.RLIMIT_AS)
    if limit != resource.RLIM_INFINITY:
        yield float(limit), float(psutil.Process().memory_info().vms)


def _group_limits(groups: Path = GROUPS, membership: Path = MEMBERSHIP) -> Iterator[tuple[float, float]]:
    """Yield the limits of the control groups that this process is in, and of those around them."""
    try:
        lines = membership.read_text().splitlines()
    except OSError:  # no Linux
        return
    for line in lines:
        _, controllers, path = line.split(":", 2)
        for files in VERSIONS:
            if files.controller in controllers.split(","):
                root = groups / files.folder
                inner = root / path.lstrip("/")
                yield from filter(None, (files.read(folder) for folder in (inner, *inner.parents)))


class _GroupFiles(NamedTuple):
    """Where a version of control groups tells of memory."""

    controller: str  # in the list of those that a process has
    folder: str
    limit: str
    used: str
    cache: str  # of files and not in use, which counts as used but would be given up; an entry of "memory.stat"

    def read(self, group: Path) -> tuple[float, float] | None:
        """Return a group's limit and what of it is used [bytes], if it has any."""
        try:
            limit, used = ((group / name).read_text().strip() for name in (self.limit, self.used))
            entries = dict(entry.split() for entry in (group / "memory.stat").read_text().splitlines())
        except OSError:  # a root, or a container that sees no groups around its own
            return None
        return None if limit == "max" else (float(limit), float(used) - float(entries.get(self.cache, 0)))


VERSIONS = (
    _GroupFiles("memory", "memory", "memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file"),
    _GroupFiles("", "", "memory.max", "memory.current", "inactive_file"),
)
