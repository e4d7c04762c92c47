"""How many threads a run computes on. Its results do not depend on that, bit for bit."""

import contextlib
import os
from collections.abc import Iterator
from typing import Any

import numba
from numba.core import config

from viscopoint.errors import InputError

SMALL = 10_000  # points or elements: beside another busy program two threads take two to ten times as long as one


def check(wanted: int | None) -> None:
    """Raise ``InputError`` if nobody can compute on so many threads; None leaves it to ``chosen``."""
    settings: Any = config
    most = settings.NUMBA_NUM_THREADS
    if wanted is None or (type(wanted) is int and 1 <= wanted <= most):
        return
    raise InputError(f"threads: {wanted!r}: this machine has {most}; write a whole number from 1 to {most}")


def chosen(wanted: int | None, size: int) -> int:
    """Return on how many threads to compute: as many as wanted, or as Numba was told, or as the size deserves.

    ``size`` is the number of points, or of elements if there are any.
    """
    settings: Any = config
    most, told = settings.NUMBA_NUM_THREADS, numba.get_num_threads()
    if wanted is not None:
        return wanted
    if told != most or most != settings.NUMBA_DEFAULT_NUM_THREADS or "NUMBA_NUM_THREADS" in os.environ:
        return told
    return 1 if size < SMALL else most


@contextlib.contextmanager
def using(number: int) -> Iterator[None]:
    """Compute on so many threads, and then on as many as before."""
    before = numba.get_num_threads()
    numba.set_num_threads(number)
    try:
        yield
    finally:
        numba.set_num_threads(before)
