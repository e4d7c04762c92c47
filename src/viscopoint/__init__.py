"""The Taylor impact test of viscoelastic solids, by the material point method and by finite elements.

>>> import viscopoint as vp
>>> case = vp.Case.load("paper").with_(material={"decay": "65 1/ms"})
>>> run = vp.run(case)
>>> run.history["velocity"]
>>> run.snapshot("20 us")["stress"]
"""

import importlib
import os
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from viscopoint.case.case import Case, packaged
    from viscopoint.comparison import Comparison, compare
    from viscopoint.errors import CaseError, InputError, OutputError, ResultWarning, ViscopointError, ViscopointWarning
    from viscopoint.reproduction import Reproduction, reproduce
    from viscopoint.results.reader import Snapshot
    from viscopoint.results.run import Run
    from viscopoint.results.running import resume, run

# A thread that waits for the others spins some ten microseconds, then sleeps. By default GNU OpenMP spins for about a
# millisecond: beside another busy program that made a step of 21,172 points on two cores 40 times slower.
os.environ.setdefault("GOMP_SPINCOUNT", "5000")

__all__ = [
    "Case",
    "CaseError",
    "Comparison",
    "InputError",
    "OutputError",
    "Reproduction",
    "ResultWarning",
    "Run",
    "Snapshot",
    "ViscopointError",
    "ViscopointWarning",
    "compare",
    "packaged",
    "reproduce",
    "resume",
    "run",
]

_HOME = {
    "Case": "case.case",
    "packaged": "case.case",
    "CaseError": "errors",
    "Comparison": "comparison",
    "compare": "comparison",
    "InputError": "errors",
    "OutputError": "errors",
    "ResultWarning": "errors",
    "ViscopointError": "errors",
    "ViscopointWarning": "errors",
    "Reproduction": "reproduction",
    "reproduce": "reproduction",
    "Run": "results.run",
    "Snapshot": "results.reader",
    "resume": "results.running",
    "run": "results.running",
}


def __dir__() -> list[str]:
    return __all__


def __getattr__(name: str) -> Any:
    """Import what is asked for, and only that: ``viscopoint --help`` need not wait for the compiler."""
    if name not in _HOME:
        raise AttributeError(f"module 'viscopoint' has no attribute '{name}'")
    return getattr(importlib.import_module(f"viscopoint.{_HOME[name]}"), name)
