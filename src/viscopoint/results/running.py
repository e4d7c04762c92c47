"""Runs a case and leaves a run folder, or goes on with one that was interrupted."""

import contextlib
import shutil
import warnings
import weakref
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from tempfile import mkdtemp
from typing import Any, NamedTuple

from viscopoint.arguments import checked
from viscopoint.case.case import Case
from viscopoint.errors import InputError, ResultWarning, ViscopointWarning
from viscopoint.kernels.promise import NOT_THE_SAME, differences, promise
from viscopoint.kernels.threads import check, chosen, using
from viscopoint.messages import clipped, one_line
from viscopoint.model.build import Model, build
from viscopoint.model.energy_balance import Row
from viscopoint.model.simulation import Simulation, Watch
from viscopoint.results import checkpoint
from viscopoint.results.checkpoint import Checkpoint, Every, Keeper
from viscopoint.results.folder import (
    CASE,
    PROVENANCE,
    SUMMARY,
    Held,
    alone,
    check_free,
    disk_faults,
    new,
    write_json,
    write_text,
)
from viscopoint.results.interruption import noted
from viscopoint.results.output import WRITERS, Mark, Writer
from viscopoint.results.provenance import now, of_resuming, provenance, sources_of
from viscopoint.results.reader import CORRUPT
from viscopoint.results.run import Run
from viscopoint.results.summary import ENDED, Summary

MOST_STEPS = 100_000_000
USUAL_CHECKPOINTS = "60 s"
Tell = Callable[[str], None]


class Company(NamedTuple):
    """Who follows a run, and what else is wanted of it."""

    watch: Watch | None  # called with the share done and the newest history row
    tell: Tell  # called with words for what begins
    figures: bool
    threads: int | None  # wanted, or None if that is left to us


@checked
def run(
    case: Case | str | Path,
    out: str | Path | None = None,
    *,
    force: bool = False,
    figures: bool = True,
    checkpoint_every: str = USUAL_CHECKPOINTS,
    threads: int | None = None,
    watch: Watch | None = None,
    tell: Tell | None = None,
) -> Run:
    """Simulate a case and return its run folder, opened.

    Args:
        case: what to simulate; text is the name of a packaged case or the path of a file, as ``Case.load`` takes it.
        out: the run folder to make; by default a temporary one that goes with the returned ``Run``.
        force: replace a run folder that is already there.
        figures: draw the figures too.
        checkpoint_every: "10 s" on the clock, "5 us simulated", or "never": from the last one ``resume`` goes on.
        threads: to compute on; results do not depend on it. By default one for a small model, else as many as Numba
            was told (``numba.set_num_threads``), or has.
        watch: called with the share done and the newest history row, after each row.
        tell: called with words for what begins, before anything that may take long.

    Returns:
        The run. Look at its ``status``: a run that a guard stopped, or Ctrl-C, is returned as far as it went.

    Raises:
        InputError: the folder is already there or cannot be made, or the case would take forever or does not fit into
            memory.
        OutputError: the results could not be written.

    Warns:
        ResultWarning: the body has not the rod's mass, some of it was lost, or hourglass control took much energy.
    """
    every, company = Every.read(checkpoint_every), Company(watch, tell or _keep_silent, figures, threads)
    check(threads)
    case = case if isinstance(case, Case) else Case.load(case)
    if out is not None:
        check_free(Path(out), force, needed=case.method.files())  # before anything takes time
    company.tell("building the model")
    model = build(case)
    _bound_steps(model)
    doubts = Summary.of_start(model).warnings
    _warn(doubts)
    temporary = Path(mkdtemp(prefix="viscopoint-")) if out is None else None
    folder = temporary / "run" if temporary else Path(out or "")
    try:
        with disk_faults(folder), new(folder, force, case.method.files()) as fresh:
            kept = case.resolved()
            kept = kept.model_copy(update={"method": kept.method.kept_in(fresh)})
            write_text(fresh / CASE, kept.to_toml())
            own = {"sources": sources_of(case), "case": _hashed(fresh, kept), "threads": chosen(threads, model.size)}
            write_json(fresh / PROVENANCE, provenance() | own)
            _write_summary(fresh, Summary.of_start(model))
            made = fresh.stat()
        with alone(folder, made) as held:
            result = _compute(held, model, every, None, company)
    except BaseException:
        if temporary:
            shutil.rmtree(temporary, ignore_errors=True)
        raise
    if temporary:
        weakref.finalize(result, shutil.rmtree, temporary, ignore_errors=True)
    _warn(result.results.warnings[len(doubts) :])
    return result


@checked
def resume(
    folder: str | Path,
    *,
    figures: bool = True,
    checkpoint_every: str = USUAL_CHECKPOINTS,
    threads: int | None = None,
    watch: Watch | None = None,
    tell: Tell | None = None,
) -> Run:
    """Go on with a run that was interrupted or killed, from its last checkpoint or else from the start.

    What it leaves has the same bits as if nothing had happened. A run that is complete is returned as it is, with its
    figures drawn if they are missing and wanted.

    Args:
        folder: the run folder.
        figures: draw the figures too.
        checkpoint_every: as ``run`` takes it.
        threads: as ``run`` takes it.
        watch: called with the share done and the newest history row, after each row.
        tell: called with words for what begins, before anything that may take long.

    Raises:
        InputError: the folder holds no run, or one by other sources than these or of what was another case, or another
            process is at work there, or its checkpoints are damaged. Nothing was changed.
        OutputError: the results could not be written.

    Warns:
        ViscopointWarning: the last checkpoint is damaged, and the one before is taken.
        ResultWarning: as ``run`` does.
    """
    folder = Path(folder)
    every, company = Every.read(checkpoint_every), Company(watch, tell or _keep_silent, figures, threads)
    check(threads)
    Run(folder)  # or it is none, and nothing in it is looked at
    _check_own(folder)
    with alone(folder) as held:
        earlier = Run(folder)
        if earlier.status in ENDED:
            with disk_faults(folder):
                return _finished(earlier, company)
        sources = sources_of(earlier.case)
        if earlier.provenance.get("sources") != sources:
            raise InputError(
                f"run folder {folder}: begun by other sources ({earlier.provenance.get('sources')}) than these "
                f"({sources}; of a law from outside the package, its own are part), which would not give the same "
                f"results; run {folder / CASE} anew"
            )
        if earlier.provenance.get("case") != _hashed(folder, earlier.case):
            raise InputError(
                f"run folder {folder}: its {CASE}, or the mesh that it names, is not what it was at the start"
            )
        company.tell("building the model")
        model = build(earlier.case)
        _bound_steps(model)
        found, faults = checkpoint.newest(folder, model.method.state())
        if faults and found is None:
            raise InputError(
                f"run folder {folder}: no checkpoint can be read ({'; '.join(faults)}); remove "
                f"{folder / checkpoint.FOLDER} to begin from the start"
            )
        if found and (found.progress.case, found.progress.sources) != (earlier.provenance["case"], sources):
            raise InputError(f"run folder {folder}: its checkpoint is not of its {CASE} or of these sources")
        for fault in faults:
            words = one_line(f"run folder {folder}: checkpoint {fault}; the one before is taken")
            warnings.warn(words, ViscopointWarning, stacklevel=2)
        changed = differences(earlier.provenance, promise())
        if changed:
            words = clipped(f"run folder {folder}: {NOT_THE_SAME}: {'; '.join(changed)}")
            warnings.warn(one_line(words), ViscopointWarning, stacklevel=2)
        news = of_resuming(earlier.provenance, changed) | {"threads": chosen(threads, model.size)}
        result = _compute(held, model, every, found, company, news)
    _warn(result.results.warnings)
    return result


def _compute(
    held: Held,
    model: Model,
    every: Every,
    found: Checkpoint | None,
    company: Company,
    news: dict[str, Any] | None = None,
) -> Run:
    """Let a model run to its end, writing into its folder, from a checkpoint if there is one.

    Nothing is written before all that is there was found to go with the checkpoint; ``news`` are of the provenance.
    """
    folder = held.folder

    def watch(share: float, row: Row) -> None:
        held.check()
        if company.watch:
            company.watch(share, row)

    with disk_faults(folder, f"; once that is mended, `viscopoint resume {folder}` goes on"):
        begun = Run(folder).provenance
        with contextlib.ExitStack() as stack:
            if found:
                company.tell("reading what is there")
            writers = [stack.enter_context(contextlib.closing(writer)) for writer in _writers(folder, model, found)]
            keeper = Keeper(held, every, begun["sources"], begun["case"])
            company.tell("going on" if found else "starting; the first time this compiles")
            stop = stack.enter_context(noted(company.tell))
            simulation = Simulation(model, writers, watch, keeper, stop)
            if found:
                _go_on(simulation, found, folder)
                checkpoint.remove_after(folder, found.progress.step)
            if news:
                write_json(folder / PROVENANCE, begun | news)
                _write_summary(folder, Summary.of_start(model))
            for writer in writers:
                writer.begin()
            with using(chosen(company.threads, model.size)), _noting_failure(held, model):
                outcome = simulation.run()
        held.check()
        start, advice = simulation.balance.start.kinetic, model.method.failure_hints
        _write_summary(folder, Summary.of_start(model).ended(outcome, start, advice))
        result = Run(folder)
        write_json(folder / PROVENANCE, result.provenance | {"ended": now()})
        result = Run(folder)
        result.body = model.body  # not made again
        return _finished(result, company)


@contextlib.contextmanager
def _noting_failure(held: Held, model: Model) -> Iterator[None]:
    """Leave a word in the summary, if an exception ends a run, on what it was: nothing is at work there any more."""
    try:
        yield
    except Exception as error:
        what = f"{type(error).__name__}: {error}" if str(error) else type(error).__name__
        with contextlib.suppress(OSError, MemoryError):
            held.check()  # another folder is left alone
            failed = {"status": "interrupted", "reason": one_line(clipped(what.partition("\n")[0]))}
            _write_summary(held.folder, Summary.of_start(model).model_copy(update=failed))
        raise


def _writers(folder: Path, model: Model, found: Checkpoint | None) -> list[Writer]:
    if found is None:
        return [make(folder, model.body, None) for make in WRITERS.values()]
    try:
        marks, snapshots = found.progress.marks, len(found.progress.rows)
        made = zip(WRITERS.values(), marks, strict=True)
        return [make(folder, model.body, Mark(*mark, snapshots)) for make, mark in made]
    except CORRUPT as error:
        if isinstance(error, MemoryError) or (isinstance(error, OSError) and error.errno):
            raise
        raise InputError(f"run folder {folder}: what it holds does not go with its checkpoint ({error})") from None


def _go_on(simulation: Simulation, found: Checkpoint, folder: Path) -> None:
    try:
        simulation.resume(found)
        found.state.clear()  # the method has it now
    except (ValueError, TypeError, OverflowError) as error:
        raise InputError(f"run folder {folder}: its checkpoint is not of its {CASE} ({error})") from None


def _finished(result: Run, company: Company) -> Run:
    """Leave nothing behind that only an unfinished run needs, and draw the figures."""
    if result.status != "interrupted":
        checkpoint.remove(result.folder)
    if company.figures and result.rows:
        company.tell("drawing figures")
        result.draw()
    return result


def _check_own(folder: Path) -> None:
    """Refuse a folder in which writing would reach files elsewhere."""
    for path in folder.rglob("*"):
        if path.is_symlink() or not (path.is_file() or path.is_dir()):
            raise InputError(
                f"run folder {folder}: {path.name} is a link or a device; only a folder of plain files can be resumed"
            )


def _warn(texts: Iterable[str]) -> None:
    """Tell whoever called ``run`` or ``resume`` what makes its numbers less than they seem."""
    for text in texts:
        warnings.warn(one_line(text), ResultWarning, stacklevel=4)  # of ``run``, ``checked`` and this


def _keep_silent(words: str) -> None:
    """Take words that nobody wants to read."""


def _write_summary(folder: Path, results: Summary) -> None:
    write_json(folder / SUMMARY, results.model_dump(by_alias=True))


def _hashed(folder: Path, case: Case) -> str:
    """Return the hash of a run folder's case and of the files that it names, which are in the folder too."""
    return checkpoint.hashed([folder / CASE, *(folder / file for file in case.method.files())])


def _bound_steps(model: Model) -> None:
    """Refuse a case that would never end, before anything is written."""
    end, step = model.case.time.end, model.method.stable_step()
    if not end / MOST_STEPS < step:
        raise InputError(
            f"time.end: {end * 1e3:g} us at a stable step of {step * 1e3:.3g} us takes more than {MOST_STEPS:,} steps; "
            "check the units of material and method"
        )
