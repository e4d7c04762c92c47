"""What the command line shows: progress, and the results of a run."""

import contextlib
import math
import sys
from collections.abc import Callable, Iterator

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn
from rich.table import Table

from viscopoint.case.description import description
from viscopoint.messages import one_line
from viscopoint.model.simulation import LOSSES
from viscopoint.results.run import Run

COLUMNS = (
    BarColumn(), TextColumn("{task.percentage:3.0f} %"), TextColumn("{task.description}"),
    TimeElapsedColumn(), TextColumn("left"), TimeRemainingColumn(),
)  # fmt: skip


@contextlib.contextmanager
def progress(begin: str) -> Iterator[Callable[[float | None, str], None]]:
    """Show a bar with the time left on a terminal, and nothing elsewhere.

    Yields what takes the share done, or None where it stays, and words for what goes on.
    """
    screen = Console(stderr=True)
    if not screen.is_terminal:
        yield _unseen
        return
    with Progress(*COLUMNS, console=screen, transient=True) as bar:
        task = bar.add_task(begin, total=1.0)

        def show(share: float | None, going_on: str) -> None:
            bar.update(task, completed=share, description=going_on)

        yield show


def _unseen(share: float | None, going_on: str) -> None:
    """Take progress that nobody sees."""


class _Screen(Console):
    """A console that tells when its reader has had enough, instead of ending the process."""

    def on_broken_pipe(self) -> None:
        raise


def console() -> Console:
    """Return where results are printed: as wide as the terminal, or wide enough for any table where there is none."""
    return _Screen(width=None if sys.stdout.isatty() else 120, highlight=False, emoji=False)


def print_summary(run: Run) -> None:
    """Print a table of the snapshots and how the run ended."""
    meshed = run.results.elements > 0
    heads = ("length", "contact r", "greatest r", "velocity", "kinetic", "impulse", "hourglass", "energy error", "lost")
    units = ("mm", "mm", "mm", "m/s", "mJ", "N ms", "%", "%", "elements" if meshed else "points")
    table = Table("time\nus", *(f"{head}\n{unit}" for head, unit in zip(heads, units, strict=True)), box=None)
    for column in table.columns:
        column.justify = "right"
    for row in run.rows:
        error = 100.0 * row.numerical / run.results.initial_energy
        table.add_row(
            f"{row.time * 1e3:g}", _known(row.length, ".3f"), _known(row.contact_radius, ".3f"),
            _known(row.greatest_radius, ".3f"), f"{row.velocity:.2f}", f"{row.kinetic:.1f}", f"{row.wall_impulse:.2f}",
            _known(row.hourglass_share, ".1f"), f"{error:+.2f}", str(row.lost),
        )  # fmt: skip
    screen = console()
    if run.case.title:
        screen.print(run.case.title, markup=False)
    screen.print(description(run.case), markup=False)
    screen.print(table)
    screen.print(_ending(run), markup=False, soft_wrap=True)
    for text in run.results.warnings:
        screen.print(f"WARNING: {one_line(text)}", markup=False, soft_wrap=True)


def _known(value: float, form: str) -> str:
    """Return a number as it is shown; what is not known, or was measured on points that are lost, is a dash."""
    return format(value, form) if math.isfinite(value) else "-"


def _ending(run: Run) -> str:
    """Say in a sentence how a run ended and where it is."""
    results, folder = run.results, one_line(str(run.folder))
    if run.status == "running":
        return f"not finished: still running, or killed; {folder}"
    parts = results.elements or results.points
    pace = parts * max(results.steps - 1, 0) / max(results.wall_time, 1e-3) / 1e6
    ended = "complete" if run.status == "complete" else f"INCOMPLETE ({results.reason})"
    if run.status == LOSSES:
        ended = f"{LOSSES} ({results.reason})"
    kind = "element" if results.elements else "point"
    work = f"{parts} {kind}s, {results.steps} steps in {results.wall_time:.2f} s"
    excess = round(results.mass_error, 2) + 0.0  # not the negative zero
    mass = f"mass {results.mass:.4g} g ({excess:+.2f} %), " if math.isfinite(results.mass) else ""
    balance = f"{mass}energy error within {results.energy_error:.2f} % of the initial kinetic energy"
    mesh = ""
    if results.mesh:
        mesh = (
            f"mesh: {results.points} nodes, least scaled Jacobian {results.mesh.least_jacobian:.2f}, greatest aspect "
            f"{results.mesh.greatest_aspect:.2f}\n"
        )
    return f"{mesh}{ended}: {work} ({pace:.1f} M {kind}-steps/s), {balance}\n{folder}"
