"""How long commands take that do next to nothing: a whole process, from the shell's point of view."""

import os
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Literal

from viscopoint.bench.record import Spread, Startup
from viscopoint.errors import ViscopointError

CACHE = "VISCOPOINT_CACHE"  # names the folder of compiled kernels' folders
FEW_STEPS = ("--set", "time.end=0.2 us", "--set", "time.snapshots=[]", "--no-figures", "--force")
RUN = "viscopoint run paper, 0.2 us"


def startups(repeats: int, cold: bool) -> Iterator[Startup]:
    """Time ``viscopoint --help`` and a run of a few steps, also without compiled kernels if ``cold`` is asked for."""
    yield _told("viscopoint --help", "filled", [seconds(["--help"]) for _ in range(1 + repeats)][1:])
    with TemporaryDirectory(prefix="viscopoint-") as folder:
        words = ["run", "paper", *FEW_STEPS, "--out", str(Path(folder, "run"))]
        kernels = Path(folder, "kernels")
        cache = {CACHE: str(kernels)} if cold else {}
        first = seconds(words, cache)
        if cold:
            if not any(kernels.glob("*/*")):
                raise ViscopointError(f"a run left no kernels in {CACHE}={kernels}: a cold start cannot be measured")
            yield _told(RUN, "empty", [first])
        yield _told(RUN, "filled", [seconds(words, cache) for _ in range(repeats)])


def seconds(words: list[str], settings: dict[str, str] | None = None) -> float:
    """Return how long a command of viscopoint takes [s]."""
    began = time.perf_counter()
    done = subprocess.run(
        [sys.executable, "-m", "viscopoint", *words], env=os.environ | (settings or {}), capture_output=True, text=True
    )
    taken = time.perf_counter() - began
    if done.returncode:
        raise ViscopointError(f"viscopoint {' '.join(words)} ended with code {done.returncode}: {done.stderr.strip()}")
    return taken


def _told(command: str, cache: Literal["empty", "filled"], values: list[float]) -> Startup:
    return Startup(command=command, cache=cache, seconds=Spread.of(values))
