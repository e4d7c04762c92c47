"""Runs a case and leaves a run folder."""

import contextlib
import shutil
import weakref
from collections.abc import Callable
from pathlib import Path
from tempfile import mkdtemp

from viscopoint.case import Case
from viscopoint.errors import InputError
from viscopoint.folder import CASE, PROVENANCE, SUMMARY, check_free, create, disk_faults, write_json, write_text
from viscopoint.model import Model, build
from viscopoint.output import WRITERS
from viscopoint.provenance import now, provenance
from viscopoint.results import Run
from viscopoint.simulation import Simulation, Watch
from viscopoint.summary import Summary

MOST_STEPS = 100_000_000


def run(
    case: Case,
    out: str | Path | None = None,
    *,
    force: bool = False,
    figures: bool = True,
    watch: Watch | None = None,
    tell: Callable[[str], None] | None = None,
) -> Run:
    """Simulate a case and return its run folder, opened.

    Args:
        case: what to simulate.
        out: the run folder to make; by default a temporary one that goes with the returned ``Run``.
        force: replace a run folder that is already there.
        figures: draw the figures too.
        watch: called with the share done and the ledger's newest row, after each row.
        tell: called with words for what begins, before anything that may take long.

    Returns:
        The run. Look at its ``status``: a run that a guard stopped, or Ctrl-C, is returned as far as it went.

    Raises:
        InputError: the folder is already there or cannot be made, or the case would take forever.
        OutputError: the results could not be written.
    """
    if out is not None:
        check_free(Path(out), force, needed=case.method.files())  # before anything takes time
    tell = tell or _keep_silent
    tell("building the model")
    model = build(case)
    _bound_steps(model)
    folder = Path(mkdtemp(prefix="viscopoint-") if out is None else out)
    create(folder, force)
    with disk_faults(folder):
        made = provenance()
        write_json(folder / PROVENANCE, made)
        summary = Summary.of_start(model.body)
        _write_summary(folder, summary)
        kept = case.resolved()
        kept = kept.model_copy(update={"method": kept.method.kept_in(folder)})
        write_text(folder / CASE, kept.to_toml())
        with contextlib.ExitStack() as stack:
            writers = [stack.enter_context(contextlib.closing(make(folder, model.body))) for make in WRITERS]
            tell("starting; the first time this compiles")
            simulation = Simulation(model, writers, watch)
            outcome = simulation.run()
        _write_summary(folder, summary.ended(outcome, simulation.ledger.start.kinetic))
        write_json(folder / PROVENANCE, made | {"ended": now()})
        result = Run(folder)
        result.body = model.body  # not made again
        if out is None:
            weakref.finalize(result, shutil.rmtree, folder, ignore_errors=True)
        if figures and outcome.rows:
            tell("drawing figures")
            result.draw()
        return result


def _keep_silent(words: str) -> None:
    """Take words that nobody wants to read."""


def _write_summary(folder: Path, results: Summary) -> None:
    write_json(folder / SUMMARY, results.model_dump(by_alias=True))


def _bound_steps(model: Model) -> None:
    """Refuse a case that would never end, before anything is written."""
    end, step = model.case.time.end, model.method.stable_step()
    if not end / MOST_STEPS < step:
        raise InputError(
            f"time.end: {end * 1e3:g} us at a stable step of {step * 1e3:.3g} us takes more than {MOST_STEPS:,} steps; "
            "check the units of material and method"
        )
