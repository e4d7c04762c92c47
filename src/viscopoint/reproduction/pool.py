"""Runs many cases at the same time, a process for each core, and takes finished ones again."""

import contextlib
import multiprocessing
import os
import signal
import threading
import warnings
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from pathlib import Path
from typing import Any

from viscopoint.case.case import Case
from viscopoint.errors import InputError, ViscopointError
from viscopoint.results.folder import CASE
from viscopoint.results.interruption import Stop, noted
from viscopoint.results.provenance import sources_of
from viscopoint.results.run import Run

Watch = Callable[[float, str], None]  # share done of the whole, what is going on
PATIENCE = 0.1  # s between two looks at the progress

_shares: Any = None  # in a worker: how far each run is, shared with the parent
_stop: Any = None  # in a worker: set by the parent when nothing more is wanted


class Pool:
    """As many worker processes as the machine has cores, each computing on one thread.

    Results do not depend on the number of threads, so one run on each core is the fastest way to many runs. Workers
    import the main module: in a script, call from below ``if __name__ == "__main__":``.
    """

    def __init__(self, tasks: int) -> None:
        """Prepare for up to ``tasks`` runs; workers start when they are needed."""
        context = multiprocessing.get_context("spawn")
        self.shares: Any = context.Array("d", max(tasks, 1), lock=False)
        self.begun: Any = context.Event()  # by the first worker that is ready
        self.stop: Any = context.Event()
        cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
        told = (self.begun, self.shares, self.stop)
        self.noting, self.asked = contextlib.ExitStack(), Stop()
        self.executor = ProcessPoolExecutor(cores, mp_context=context, initializer=_begin, initargs=told)

    def __enter__(self) -> "Pool":
        # an exception raised just anywhere may be lost, in a callback of the interpreter's own
        self.asked = self.noting.enter_context(noted())
        return self

    def __exit__(self, kind: type | None, *rest: Any) -> None:
        self.noting.close()
        if kind is not None:
            self.stop.set()  # also for what goes on, and for what a worker has fetched already
        try:
            self.executor.shutdown(wait=True, cancel_futures=kind is not None)
        except KeyboardInterrupt:  # a second time: at once
            for worker in multiprocessing.active_children():
                worker.kill()
            raise
        if kind is None:
            self.asked.obey()

    def finish(self, cases: Mapping[str, Case], folder: Path, watch: Watch | None = None) -> dict[str, Run]:
        """Return a finished run of each case, kept in ``folder`` under its name: the one there, or a new one.

        Raises:
            ViscopointError: a run was stopped by a guard, or a worker died; what was finished stays.
            InputError, OutputError: as ``run`` raises them.
        """
        missing = {name: case for name, case in cases.items() if not _is_finished(folder / name, case)}
        with _deaf_children():
            futures = {
                self.executor.submit(_simulate, place, case, folder / name): name
                for place, (name, case) in enumerate(missing.items())
            }
        self._wait(futures, watch)
        runs = {name: Run(folder / name) for name in cases}
        for name, run in runs.items():
            if run.status == "interrupted":
                raise KeyboardInterrupt
            if run.status != "complete":
                raise ViscopointError(f"run {name} is {run.status}: {run.results.reason}; see {run.folder}")
        return runs

    def begin(self, function: Callable[..., Any], arguments: Iterable[tuple[Any, ...]]) -> Callable[[], None]:
        """Begin to call a function with each tuple of arguments; return what waits for the end."""
        with _deaf_children():
            futures = {self.executor.submit(function, *words): "" for words in arguments}
        return lambda: self._wait(futures, None)

    def _wait(self, futures: Mapping[Future[Any], str], watch: Watch | None) -> None:
        """Wait for all; raise what the first to fail raised, and begin nothing more."""
        left = set(futures)
        try:
            while left:
                self.asked.obey()
                done, left = wait(left, timeout=PATIENCE, return_when=FIRST_COMPLETED)
                for future in done:
                    future.result()
                if watch:
                    going_on = [futures[future] for future in futures if future.running() and not future.done()]
                    watch(sum(self.shares[: len(futures)]) / len(futures), ", ".join(going_on[: os.cpu_count()]))
        except BrokenProcessPool:
            killed = "a worker process was killed, perhaps for want of memory; what was finished stays"
            none = (
                'no worker process could start; in a script, call from below `if __name__ == "__main__":`, from a file'
            )
            raise ViscopointError(killed if self.begun.is_set() else none) from None
        except BaseException:
            for future in left:
                future.cancel()
            raise


@contextlib.contextmanager
def _deaf_children() -> Iterator[None]:
    """Start processes that Ctrl-C does not reach: the parent alone decides what ends."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _begin(begun: Any, shares: Any, stop: Any) -> None:
    """Prepare a worker."""
    global _shares, _stop  # the only way into a worker
    _shares, _stop = shares, stop
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with_parent, daemon=True).start()
    begun.set()


def _end_with_parent() -> None:
    """Wait for the parent to be gone, even killed, and go too."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


def _simulate(place: int, case: Case, folder: Path) -> None:
    """Run a case in a worker."""
    from viscopoint.errors import ResultWarning
    from viscopoint.results.running import resume, run

    def watch(share: float, row: Any) -> None:
        _shares[place] = share
        if _stop.is_set():
            raise KeyboardInterrupt

    if _stop.is_set():
        return
    warnings.simplefilter("ignore", ResultWarning)  # the page says them
    if _is_run(folder, case, ("running", "interrupted")):
        with contextlib.suppress(InputError):  # damaged: to be made again
            resume(folder, figures=False, threads=1, watch=watch)
            return
    run(case, folder, force=True, figures=False, threads=1, watch=watch)


def _is_run(folder: Path, case: Case, statuses: Collection[str]) -> bool:
    """Return whether a folder holds a run of this very case by this very version, of such a status."""
    if not (folder / CASE).is_file():
        return False
    try:
        run = Run(folder)
        same = run.provenance.get("sources") == sources_of(case) and run.case == case.resolved()
        return same and run.status in statuses
    except InputError:  # damaged, or of another version: to be made again
        return False


def _is_finished(folder: Path, case: Case) -> bool:
    """Return whether a folder holds a complete run of this very case by this very version."""
    if not _is_run(folder, case, ("complete",)):
        return False
    try:
        run = Run(folder)
        return len(run.times) == len(run.rows) and len(run.history) > 0 and run.snapshot(-1).time > 0.0
    except InputError:  # damaged, or of another version: to be made again
        return False
