"""The command line: thin, and quick to answer."""

import contextlib
import errno
import gc
import io
import os
import sys
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from viscopoint.messages import one_line
from viscopoint.results import interruption

if TYPE_CHECKING:
    from viscopoint.model.energy_balance import Row
    from viscopoint.results.run import Run

app = typer.Typer(
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    help="A laboratory for the Taylor impact test of viscoelastic solids.",
    epilog="Exit codes: 0 done, 1 stopped by a guard, 2 bad input, 3 results could not be written, 130 interrupted "
    "(143: by SIGTERM). Output that nobody reads, as after `| head -1` or `>&-`, changes none of them. "
    "The environment variable VISCOPOINT_CACHE names the folder of compiled code (default: the user's cache folder).",
)

CaseName = Annotated[
    str, typer.Argument(metavar="CASE", help="A packaged case (see `viscopoint cases`) or a TOML file.")
]
RunFolder = Annotated[Path, typer.Argument(metavar="RUN", help="A run folder.")]
Set = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="KEY=VALUE",
        help='Change a key of the case, as in --set rod.radius="4 mm"; order does not matter. '
        "A table in braces replaces the whole table.",
    ),
]
CheckpointEvery = Annotated[
    str,
    typer.Option(
        "--checkpoint-every",
        metavar="TIME",
        help='How often to save what `viscopoint resume` goes on from: every "10 s" on the clock, "5 us simulated", or '
        '"never".',
    ),
]
Figures = Annotated[bool, typer.Option(help="Draw the figures.")]
Threads = Annotated[
    int | None, typer.Option(help="Threads to compute with (default: one for a small model, else all).")
]


def _print_version(wanted: bool) -> None:
    if wanted:
        from importlib.metadata import version

        typer.echo(f"viscopoint {version('viscopoint')}")
        raise typer.Exit


@app.callback()
def options(
    version: Annotated[
        bool, typer.Option("--version", callback=_print_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    """Take what comes before the command."""


@app.command()
def run(
    case: CaseName,
    out: Annotated[
        Path | None, typer.Option(help="The run folder to make (default: runs/CASE, or runs/CASE-METHOD).")
    ] = None,
    method: Annotated[
        str | None,
        typer.Option(
            help="mpm, fem or tlmpm, at the case's distance of points or nodes, geometry and bulk viscosity, and all "
            "else as usual (default: the case's own)."
        ),
    ] = None,
    changes: Set = None,
    force: Annotated[bool, typer.Option("--force", help="Replace a run folder that is already there.")] = False,
    threads: Threads = None,
    figures: Figures = True,
    checkpoint_every: CheckpointEvery = "60 s",
) -> None:
    """Simulate a case and leave a run folder."""
    with _messages(), _followed() as company:
        from viscopoint.case.case import Case, changes_of
        from viscopoint.results.running import run as run_case

        resolved = Case.load(case, changes_of(changes or []), method=method)
        name = Path(case).name.removesuffix(".toml")
        folder = out or Path("runs", f"{name}-{method}" if method else name)
        company.done = run_case(
            resolved, folder, force=force, figures=figures, checkpoint_every=checkpoint_every,
            threads=threads, watch=company.watch, tell=company.tell,
        )  # fmt: skip


@app.command()
def resume(
    run: RunFolder, threads: Threads = None, figures: Figures = True, checkpoint_every: CheckpointEvery = "60 s"
) -> None:
    """Go on with a run that was interrupted or killed, as if nothing had happened."""
    with _messages(), _followed() as company:
        from viscopoint.results.running import resume as resume_run

        company.done = resume_run(
            run, figures=figures, checkpoint_every=checkpoint_every, threads=threads,
            watch=company.watch, tell=company.tell,
        )  # fmt: skip


@app.command()
def verify(run: RunFolder, threads: Threads = None) -> None:
    """Run the case of a finished run again and compare the results bit by bit."""
    with _messages():
        from viscopoint.command_line import terminal
        from viscopoint.results.verify import verify as verify_run

        with terminal.progress("reading") as progress:
            company = _Company(progress)
            verdict = verify_run(run, threads=threads, watch=company.watch, tell=company.tell)
        with _to_the_last_reader():
            for words in verdict.words():
                typer.echo(words)
        if not verdict.same:
            raise typer.Exit(1)


@app.command()
def show(run: RunFolder) -> None:
    """Print the results of a run."""
    with _messages():
        from viscopoint.command_line.terminal import print_summary
        from viscopoint.results.run import Run

        print_summary(Run(run))


@app.command()
def animate(
    run: RunFolder,
    field: Annotated[
        str, typer.Option(help="What colours it, such as von_mises, stress_zz or velocity.")
    ] = "velocity_z",
    out: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="The film to write, .mp4 or .gif (default: RUN/figures/FIELD.mp4)."),
    ] = None,
    seconds: Annotated[float, typer.Option(help="How long it lasts.")] = 6.0,
    force: Annotated[bool, typer.Option("--force", help="Replace the file if it is there.")] = False,
) -> None:
    """Draw all snapshots of a run into a film."""
    with _messages():
        from viscopoint.errors import InputError
        from viscopoint.results.folder import FIGURES
        from viscopoint.results.run import Run

        file = out or run / FIGURES / f"{field}.mp4"
        if file.exists() and not force:
            raise InputError(f"film {file}: already there; --force replaces it, --out chooses another place")
        typer.echo(one_line(str(Run(run).animate(file, field, seconds=seconds))))


@app.command()
def compare(
    runs: Annotated[list[Path], typer.Argument(metavar="RUN RUN...", help="Run folders; the first is the reference.")],
    out: Annotated[Path, typer.Option(help="The folder to make for comparison.json and figures.")] = Path("comparison"),
    force: Annotated[bool, typer.Option("--force", help="Replace an earlier comparison.")] = False,
    any_physics: Annotated[
        bool, typer.Option("--any-physics", help="Compare even runs of different rods, impacts or materials.")
    ] = False,
    figures: Annotated[bool, typer.Option(help="Draw the figures.")] = True,
) -> None:
    """Compare runs of the same impact: shapes, velocities, forces, energies."""
    with _messages():
        from viscopoint import comparison
        from viscopoint.command_line.terminal import console
        from viscopoint.comparison.table import NOTE, tables
        from viscopoint.results.folder import check_free

        check_free(out, force, comparison.NAME, runs)  # before anything takes time
        made = comparison.compare(runs, any_physics=any_physics)
        comparison.write(made, out, force=force, figures=figures)
        screen = console()
        for table in tables(made, screen.width):
            screen.print(table)
        for text in (*made.warnings(), NOTE):
            screen.print(text, markup=False)
        screen.print(one_line(str(out)), markup=False, soft_wrap=True)


@app.command()
def reproduce(
    only: Annotated[
        list[str] | None, typer.Option(metavar="FIGURE", help="Draw one figure, such as fig5, without a report.")
    ] = None,
    resolution: Annotated[str, typer.Option(help="paper, or fine: half the paper's distances too.")] = "paper",
    out: Annotated[Path, typer.Option(help="The folder for runs, figures and report.")] = Path("runs/reproduction"),
) -> None:
    """Reproduce the paper: its figures by both methods, its statements checked, and a report."""
    with _messages():
        from viscopoint import reproduction
        from viscopoint.command_line.terminal import console, progress
        from viscopoint.reproduction.table import tables

        with progress("starting") as watch:
            made = reproduction.reproduce(out, only or (), resolution, watch)
        screen = console()
        for table in tables(made):
            screen.print(table)
        screen.print(f"{made.wall_time:.0f} s", markup=False)
        for file in (*made.figures.values(), *([made.report] if made.report else [])):
            screen.print(one_line(str(file)), markup=False, soft_wrap=True)


@app.command()
def bench(
    quick: Annotated[bool, typer.Option("--quick", help="One size, one law, fewer repeats: below a minute.")] = False,
    threads: Annotated[
        str | None, typer.Option(metavar="N,...", help="Numbers of threads (default: 1, 2, 4, ... and all).")
    ] = None,
    size: Annotated[
        str | None,
        typer.Option(help="How far up: tiny (3k points), small (21k), medium (and 169k; default), large (and 1.35M)."),
    ] = None,
    only: Annotated[
        str | None, typer.Option(metavar="TEXT", help='Only what has this in its name, such as "mpm quadratic".')
    ] = None,
    out: Annotated[Path | None, typer.Option(metavar="FILE.json", help="Keep all figures in a file.")] = None,
    compare: Annotated[
        Path | None, typer.Option(metavar="OLD.json", help="Show ratios to figures that were kept.")
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace the file if it is there.")] = False,
) -> None:
    """Measure speed, memory and start-up on this machine: some minutes, plus compiling the first time."""
    with _messages():
        from viscopoint.bench import compare as comparing
        from viscopoint.bench import measure, planned, record, table
        from viscopoint.command_line import terminal

        old = record.read(compare) if compare else None
        plan = planned(quick, threads, size, only)
        if out:
            record.check_free(out, force)  # before anything takes time
        with terminal.progress("starting") as watch:
            made = measure(plan, watch)
        if out:
            record.write(made, out)
        screen = terminal.console()
        for shown in (*table.tables(made), *([comparing.table(old, made)] if old else [])):
            screen.print(shown)
            screen.print()
        for text in (*table.notes(made), *(comparing.notes(old, made) if old else ())):
            screen.print(text, markup=False)
        if out:
            screen.print(one_line(str(out)), markup=False, soft_wrap=True)


@app.command()
def cases() -> None:
    """List the packaged cases."""
    with _messages():
        from viscopoint.case.case import Case, packaged
        from viscopoint.case.description import description

        for name, title in packaged().items():
            typer.echo(f"{name:15} {title}\n{'':15} {description(Case.load(name))}")


@app.command()
def new(
    file: Annotated[Path, typer.Argument(help="The case file to write.")] = Path("case.toml"),
    force: Annotated[bool, typer.Option("--force", help="Replace the file if it is there.")] = False,
) -> None:
    """Write a commented case to start from."""
    with _messages():
        from importlib import resources

        from viscopoint.errors import InputError
        from viscopoint.results.folder import write_text

        if file.exists() and not force:
            raise InputError(f"case file {file}: already there; --force replaces it")
        try:
            write_text(file, (resources.files("viscopoint.case.library") / "starter.txt").read_text(encoding="utf-8"))
        except OSError as error:
            raise InputError(f"case file {file}: cannot be written ({error.strerror})") from None
        name = one_line(str(file))
        typer.echo(f"{name}: run it with `viscopoint run {name}`")


@app.command()
def schema() -> None:
    """Print the JSON schema of case files, for editors."""
    with _messages():
        import json

        from viscopoint.case.case import Case

        typer.echo(json.dumps(Case.file_schema(), indent=2))


def main() -> None:
    """Run the command line."""
    _fill_closed_streams()
    gc.set_threshold(100_000)  # hardly anything that imports and figures make is garbage: looking takes 0.2 s
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")  # what a narrow terminal cannot show
    app()


def _fill_closed_streams() -> None:
    """Open what was closed (``>&-``) as a sink, or the next file that is opened would take its place."""
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # the lowest number that is free: this one
    sys.stdout = sys.stdout or os.fdopen(os.open(os.devnull, os.O_WRONLY), "w")
    sys.stderr = sys.stderr or os.fdopen(os.open(os.devnull, os.O_WRONLY), "w")


@contextlib.contextmanager
def _to_the_last_reader() -> Iterator[None]:
    """Drop what is printed once its reader has had enough, as of ``| head -1``: that is no fault."""
    try:
        yield
    except OSError as error:
        if error.errno != errno.EPIPE:
            raise
        for stream in (sys.stdout, sys.stderr):
            try:
                stream.flush()
            except OSError:  # what is left in it would be tried again at the end
                os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())


def _say(words: str) -> None:
    """Print a message, if anybody listens."""
    with _to_the_last_reader():
        typer.echo(words, err=True)


@contextlib.contextmanager
def _messages() -> Any:
    """Turn our errors into one message and an exit code."""
    from viscopoint.errors import OutputError, ViscopointError

    try:
        with interruption.raising(), _warnings(), _to_the_last_reader():
            yield
    except ViscopointError as error:
        _say(f"viscopoint: {error}")
        raise typer.Exit(error.exit_code) from None
    except MemoryError as error:
        _say(f"viscopoint: memory ran out ({one_line(str(error)) or 'no more is told'})")
        raise typer.Exit(OutputError.exit_code) from None
    except OSError as error:
        _say(f"viscopoint: {one_line(str(error))}")
        raise typer.Exit(OutputError.exit_code) from None
    except KeyboardInterrupt as error:
        _say("viscopoint: interrupted")
        name = "SIGTERM" if isinstance(error, interruption.Terminated) else "SIGINT"
        raise typer.Exit(interruption.exit_code(name)) from None


@contextlib.contextmanager
def _warnings() -> Iterator[None]:
    """Print our warnings as our messages; those of others as usual."""
    from viscopoint.errors import ViscopointWarning

    usual = warnings.showwarning

    def show(words: Warning | str, category: type[Warning], *where: Any) -> None:
        if issubclass(category, ViscopointWarning):
            _say(f"viscopoint: {words}")
        else:
            usual(words, category, *where)

    with warnings.catch_warnings():
        warnings.showwarning = show
        yield


class _Company:
    """Shows how a run goes, and takes it when it is done."""

    def __init__(self, progress: Any) -> None:
        self.progress = progress
        self.done: Run | None = None

    def watch(self, share: float, row: "Row") -> None:
        self.progress(share, f"{row.time * 1e3:.2f} us, step {row.step}")

    def tell(self, words: str) -> None:
        self.progress(None, words)


@contextlib.contextmanager
def _followed() -> Iterator[_Company]:
    """Show how a run goes; print its results and exit as it ended."""
    from viscopoint.command_line import terminal
    from viscopoint.errors import ResultWarning

    with interruption.ending_at_once(), terminal.progress("reading") as progress, warnings.catch_warnings():
        warnings.simplefilter("ignore", ResultWarning)  # below the table
        company = _Company(progress)
        yield company
    done = company.done
    assert done is not None
    with _to_the_last_reader():
        terminal.print_summary(done)
    if done.status == "interrupted":
        _say(f"viscopoint: go on with `viscopoint resume {one_line(str(done.folder))}`")
        raise typer.Exit(interruption.exit_code(done.results.signal))
    raise typer.Exit(0 if done.results.is_complete else 1)
