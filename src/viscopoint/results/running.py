"""Runs a case, in memory or into a run folder, or goes on with one that was interrupted."""

import contextlib
import warnings
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

from viscopoint.arguments import checked
from viscopoint.case.case import Case
from viscopoint.case.schedules import MOST_TIMES
from viscopoint.errors import InputError, ResultWarning, ViscopointWarning
from viscopoint.kernels.promise import NOT_THE_SAME, differences, promise
from viscopoint.kernels.threads import check, chosen, using
from viscopoint.messages import clipped, one_line
from viscopoint.model.build import Model, build
from viscopoint.model.callbacks import Callback, OnRows
from viscopoint.model.energy_balance import Row
from viscopoint.model.simulation import Simulation
from viscopoint.results import checkpoint
from viscopoint.results.checkpoint import Checkpointer, Every
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
from viscopoint.results.memory import FieldsInMemory, RunInMemory
from viscopoint.results.output import OUTPUTS
from viscopoint.results.provenance import now, of_resuming, provenance, sources_of
from viscopoint.results.run import Run
from viscopoint.results.summary import ENDED, Summary

MOST_STEPS = 100_000_000
USUAL_CHECKPOINTS = "60 s"
Watch = Callable[[float, Row], None]
Tell = Callable[[str], None]


class Options(NamedTuple):
    """How to run, beside the case."""

    watch: Watch | None  # called with the share done and the newest history row
    tell: Tell  # called with words for what begins
    figures: bool
    threads: int | None  # wanted, or None if that is left to us
    callbacks: Sequence[Callback]


class _Reporter(OnRows):
    """Tells who watches how far a run is; ends it if its folder was moved."""

    def __init__(self, options: Options, held: Held | None = None) -> None:
        self.watch, self.held = options.watch, held

    def __call__(self, simulation: Simulation) -> None:
        if self.held:
            self.held.check()
        if self.watch:
            self.watch(simulation.share, simulation.history.newest)


@checked
def run(
    case: Case | str | Path,
    folder: str | Path | None = None,
    *,
    force: bool = False,
    figures: bool = True,
    checkpoint_every: str = USUAL_CHECKPOINTS,
    threads: int | None = None,
    watch: Watch | None = None,
    tell: Tell | None = None,
    callbacks: Sequence[Callback] = (),
) -> Run:
    """Simulate a case and return its results.

    Args:
        case: what to simulate; text is the name of a packaged case or the path of a file, as ``Case.load`` takes it.
        folder: the run folder to make; without one no file is written, and the results last as long as the ``Run``.
        force: replace a run folder that is already there.
        figures: draw the figures too, into the run folder.
        checkpoint_every: "10 s" on the clock, "5 us simulated", or "never": from the last one ``resume`` goes on.
        threads: to compute on; results do not depend on it. By default one for a small model, else as many as Numba
            was told (``numba.set_num_threads``), or has.
        watch: called with the share done and the newest history row, after each row.
        tell: called with words for what begins, before anything that may take long.
        callbacks: what else to call in the course of the run (``model.callbacks.Callback``).

    Returns:
        The run. Look at its ``status``: a run that a guard stopped, or Ctrl-C, is returned as far as it went.

    Raises:
        InputError: the folder is already there or cannot be made, or the case would take forever or does not fit into
            memory.
        OutputError: the results could not be written.

    Warns:
        ResultWarning: the body has not the rod's mass, some of it was lost, or hourglass control took much energy.
    """
    every, options = Every.read(checkpoint_every), Options(watch, tell or _keep_silent, figures, threads, callbacks)
    check(threads)
    case = case if isinstance(case, Case) else Case.load(case)
    if folder is not None:
        check_free(Path(folder), force, needed=case.method.files())  # before anything takes time
    options.tell("building the model")
    model = build(case)
    _bound_steps(model)
    doubts = Summary.of_start(model).warnings
    _warn(doubts)
    result = (
        _in_memory(model, options) if folder is None else _in_folder(case, model, Path(folder), force, every, options)
    )
    _warn(result.results.warnings[len(doubts) :])
    return result


def _in_memory(model: Model, options: Options) -> Run:
    """Let a model run to its end without any file."""
    fields = FieldsInMemory()
    options.tell("starting; the first time this compiles")
    threads = chosen(options.threads, model.size)
    with noted(options.tell) as stop, using(threads), contextlib.ExitStack() as stack:
        for callback in options.callbacks:
            stack.callback(callback.close)
        simulation = Simulation(model, [_Reporter(options), fields, *options.callbacks], stop)
        outcome = simulation.run()
    return RunInMemory(simulation, outcome, fields, threads)


def _in_folder(case: Case, model: Model, folder: Path, force: bool, every: Every, options: Options) -> Run:
    """Make a run folder and let a model run to its end."""
    with disk_faults(folder), new(folder, force, case.method.files()) as fresh:
        kept = case.resolved()
        kept = kept.model_copy(update={"method": kept.method.kept_in(fresh)})
        write_text(fresh / CASE, kept.to_toml())
        own = {
            "sources": sources_of(case),
            "case": _hashed(fresh, kept),
            "threads": chosen(options.threads, model.size),
        }
        write_json(fresh / PROVENANCE, provenance() | own)
        _write_summary(fresh, Summary.of_start(model))
        made = fresh.stat()
    with alone(folder, made) as held:
        return _compute(held, model, every, options)


@checked
def resume(
    folder: str | Path,
    *,
    figures: bool = True,
    checkpoint_every: str = USUAL_CHECKPOINTS,
    threads: int | None = None,
    watch: Watch | None = None,
    tell: Tell | None = None,
    callbacks: Sequence[Callback] = (),
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
        callbacks: as ``run`` takes them; with those that the run was begun with, their state goes on too.

    Raises:
        InputError: the folder holds no run, or one by other sources than these or of what was another case, or another
            process is at work there, or its checkpoints are damaged. Nothing was changed.
        OutputError: the results could not be written.

    Warns:
        ViscopointWarning: the last checkpoint is damaged, and the one before is taken.
        ResultWarning: as ``run`` does.
    """
    folder = Path(folder)
    every, options = Every.read(checkpoint_every), Options(watch, tell or _keep_silent, figures, threads, callbacks)
    check(threads)
    Run(folder)  # or it is none, and nothing in it is looked at
    _check_own(folder)
    with alone(folder) as held:
        earlier = Run(folder)
        if earlier.status in ENDED:
            with disk_faults(folder):
                return _finished(earlier, options)
        _check_sources(earlier)
        options.tell("building the model")
        model = build(earlier.case)
        _bound_steps(model)
        result = _compute(held, model, every, options, earlier)
    _warn(result.results.warnings)
    return result


def _check_sources(earlier: Run) -> None:
    """Refuse to go on with what would not give the same results."""
    folder, sources = earlier.folder, sources_of(earlier.case)
    if earlier.provenance.get("sources") != sources:
        raise InputError(
            f"run folder {folder}: begun by other sources ({earlier.provenance.get('sources')}) than these "
            f"({sources}; of a law from outside the package, its own are part), which would not give the same "
            f"results; run {folder / CASE} anew"
        )
    if earlier.provenance.get("case") != _hashed(folder, earlier.case):
        raise InputError(f"run folder {folder}: its {CASE}, or the mesh that it names, is not what it was at the start")


def _compute(held: Held, model: Model, every: Every, options: Options, earlier: Run | None = None) -> Run:
    """Let a model run to its end, writing into its folder; if it was begun earlier, from its last checkpoint.

    Nothing is written before all that is there was found to go with the checkpoint.
    """
    folder = held.folder
    with disk_faults(folder, f"; once that is mended, `viscopoint resume {folder}` goes on"):
        begun = Run(folder).provenance
        outputs = [make(folder, model) for make in OUTPUTS.values()]
        keeper = Checkpointer(held, every, begun["sources"], begun["case"])
        callbacks = [_Reporter(options, held), *outputs, *options.callbacks, keeper]
        with noted(options.tell) as stop, contextlib.ExitStack() as stack:
            simulation = Simulation(model, callbacks, stop)
            found = _go_on(simulation, earlier) if earlier else None
            if earlier:
                checkpoint.remove_after(folder, simulation.step)
                changed = differences(begun, promise())
                news = of_resuming(begun, changed) | {"threads": chosen(options.threads, model.size)}
                write_json(folder / PROVENANCE, begun | news)
                _write_summary(folder, Summary.of_start(model))
            options.tell("going on" if found else "starting; the first time this compiles")
            for callback in callbacks:
                stack.callback(callback.close)
            with using(chosen(options.threads, model.size)), _noting_failure(held, model):
                outcome = simulation.run()
        held.check()
        start, advice = simulation.balances[0].start.kinetic, model.method.failure_hints
        _write_summary(folder, Summary.of_start(model).ended(outcome, start, advice))
        write_json(folder / PROVENANCE, Run(folder).provenance | {"ended": now()})
        result = Run(folder)
        result.body = model.body  # not made again
        return _finished(result, options)


def _go_on(simulation: Simulation, earlier: Run) -> bool:
    """Take over the last sound checkpoint of a run, if it has one; warn of what may change the last bits."""
    folder = earlier.folder
    found, faults = checkpoint.newest(folder, simulation.state())
    if faults and found is None:
        raise InputError(
            f"run folder {folder}: no checkpoint can be read ({'; '.join(faults)}); remove "
            f"{folder / checkpoint.FOLDER} to begin from the start"
        )
    for fault in faults:
        _warn([f"run folder {folder}: checkpoint {fault}; the one before is taken"], ViscopointWarning)
    if found:
        words, state = found
        if (words.case, words.sources) != (earlier.provenance["case"], earlier.provenance["sources"]):
            raise InputError(f"run folder {folder}: its checkpoint is not of its {CASE} or of these sources")
        try:
            simulation.restore(words.progress, state)
        except (ValueError, TypeError, OverflowError, IndexError) as error:
            told = f"run folder {folder}: what it holds does not go with its checkpoint ({error})"
            raise InputError(one_line(told)) from None
    changed = differences(earlier.provenance, promise())
    if changed:
        _warn([clipped(f"run folder {folder}: {NOT_THE_SAME}: {'; '.join(changed)}")], ViscopointWarning)
    return found is not None


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


def _finished(result: Run, options: Options) -> Run:
    """Leave nothing behind that only an unfinished run needs, and draw the figures."""
    if result.status != "interrupted":
        checkpoint.remove(result.folder)
    if options.figures and result.rows:
        options.tell("drawing figures")
        result.draw()
    return result


def _check_own(folder: Path) -> None:
    """Refuse a folder in which writing would reach files elsewhere."""
    for path in folder.rglob("*"):
        if path.is_symlink() or not (path.is_file() or path.is_dir()):
            raise InputError(
                f"run folder {folder}: {path.name} is a link or a device; only a folder of plain files can be resumed"
            )


def _warn(texts: Iterable[str], kind: type[ViscopointWarning] = ResultWarning) -> None:
    """Tell whoever called ``run`` or ``resume`` what makes its numbers less than they seem."""
    for text in texts:
        warnings.warn(one_line(text), kind, stacklevel=4)  # of ``run``, ``checked`` and this


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
    every = model.case.time.snapshots.steps
    if every and end / (step * every) > MOST_TIMES:
        raise InputError(
            f"time.snapshots: each {every} of about {end / step:.3g} steps; no more than {MOST_TIMES:,} are kept"
        )
