"""By how much a process grows for a model, measured in one of its own (see ``growth``)."""

import subprocess
import sys

from viscopoint.bench.work import Work
from viscopoint.errors import ViscopointError

MODULE = "viscopoint.bench.growth"


def measured_growth(work: Work) -> int:
    """Return by how much a new process grows as it builds a work's model and takes some steps [bytes]."""
    done = subprocess.run([sys.executable, "-m", MODULE, *work], capture_output=True, text=True)
    if done.returncode:
        told = done.stderr.strip()
        raise ViscopointError(f"memory of {work.name}: the process ended with code {done.returncode}: {told}")
    return int(done.stdout)
