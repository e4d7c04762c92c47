"""The command line: thin, and quick to answer."""

import contextlib
import sys
import tomllib
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

if TYPE_CHECKING:
    from viscopoint.ledger import Row
    from viscopoint.results import Run

app = typer.Typer(
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    help="A laboratory for the Taylor impact test of viscoelastic solids.",
    epilog="Exit codes: 0 done, 1 stopped by a guard, 2 bad input, 3 results could not be written, 130 interrupted.",
)

CaseName = Annotated[
    str, typer.Argument(metavar="CASE", help="A packaged case (see `viscopoint cases`) or a TOML file.")
]
RunFolder = Annotated[Path, typer.Argument(metavar="RUN", help="A run folder.")]
Set = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="KEY=VALUE", help='Change a key of the case, as in --set rod.radius="4 mm".'),
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
        typer.Option(help="mpm or fem, at the case's distance of points or nodes (default: the case's own)."),
    ] = None,
    changes: Set = None,
    force: Annotated[bool, typer.Option("--force", help="Replace a run folder that is already there.")] = False,
    threads: Annotated[int | None, typer.Option(min=1, help="Threads to compute with (default: all).")] = None,
    figures: Annotated[bool, typer.Option(help="Draw the figures.")] = True,
) -> None:
    """Simulate a case and leave a run folder."""
    with _messages():
        from viscopoint.case import Case
        from viscopoint.running import run as run_case

        resolved = Case.load(case, _changes(changes), method=method)
        _use_threads(threads)
        name = Path(case).name.removesuffix(".toml")
        folder = out or Path("runs", f"{name}-{method}" if method else name)
        with _progress("compiling") as progress:

            def watch(share: float, row: "Row") -> None:
                progress(share, f"{row.time * 1e3:.2f} us, step {row.step}")

            done = run_case(resolved, folder, force=force, figures=figures, watch=watch)
        _print_summary(done)
    raise typer.Exit({"complete": 0, "interrupted": 130}.get(done.status, 1))


@app.command()
def show(run: RunFolder) -> None:
    """Print the results of a run."""
    with _messages():
        from viscopoint.results import Run

        _print_summary(Run(run))


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
        from viscopoint.comparison.table import NOTE, tables

        made = comparison.compare(runs, any_physics=any_physics)
        comparison.write(made, out, force=force, figures=figures)
        console = _console()
        for table in tables(made):
            console.print(table)
        for run in made.runs:
            if run.status != "complete":
                console.print(f"INCOMPLETE: {run.folder} ({run.results.reason})", markup=False, soft_wrap=True)
        console.print(f"{NOTE}\n{out}", markup=False)


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
        from viscopoint.reproduction.table import tables

        with _progress("starting") as watch:
            made = reproduction.reproduce(out, only or (), resolution, watch)
        console = _console()
        for table in tables(made):
            console.print(table)
        console.print(f"{made.wall_time:.0f} s", markup=False)
        for file in (*made.figures.values(), *([made.report] if made.report else [])):
            console.print(str(file), markup=False, soft_wrap=True)


@app.command()
def cases() -> None:
    """List the packaged cases."""
    with _messages():
        from viscopoint.case import packaged

        for name, title in packaged().items():
            typer.echo(f"{name:15} {title}")


@app.command()
def new(
    file: Annotated[Path, typer.Argument(help="The case file to write.")] = Path("case.toml"),
    force: Annotated[bool, typer.Option("--force", help="Replace the file if it is there.")] = False,
) -> None:
    """Write a commented case to start from."""
    with _messages():
        from importlib import resources

        from viscopoint.errors import InputError
        from viscopoint.folder import write_text

        if file.exists() and not force:
            raise InputError(f"case file {file}: already there; --force replaces it")
        try:
            write_text(file, (resources.files("viscopoint.cases") / "starter.txt").read_text(encoding="utf-8"))
        except OSError as error:
            raise InputError(f"case file {file}: cannot be written ({error.strerror})") from None
        typer.echo(f"{file}: run it with `viscopoint run {file}`")


@app.command()
def schema() -> None:
    """Print the JSON schema of case files, for editors."""
    with _messages():
        import json

        from viscopoint.case import Case

        typer.echo(json.dumps(Case.file_schema(), indent=2))


def main() -> None:
    """Run the command line."""
    app()


@contextlib.contextmanager
def _messages() -> Any:
    """Turn our errors into one message and an exit code."""
    from viscopoint.errors import ViscopointError

    try:
        yield
    except ViscopointError as error:
        typer.echo(f"viscopoint: {error}", err=True)
        raise typer.Exit(error.exit_code) from None
    except KeyboardInterrupt:
        typer.echo("viscopoint: interrupted", err=True)
        raise typer.Exit(130) from None


def _changes(settings: list[str] | None) -> dict[str, Any]:
    """Read --set KEY=VALUE, the value as TOML or else as bare text."""
    from viscopoint.errors import InputError

    changes: dict[str, Any] = {}
    for setting in settings or []:
        key, equals, text = setting.partition("=")
        if not equals or not all(part.strip() for part in key.split(".")):
            raise InputError(f"--set {setting}: write it as KEY=VALUE, such as rod.radius='4 mm'")
        try:
            changes[key.strip()] = tomllib.loads(f"value = {text}")["value"]
        except (tomllib.TOMLDecodeError, KeyError):
            changes[key.strip()] = text.strip()
    return changes


def _use_threads(threads: int | None) -> None:
    import numba

    from viscopoint.errors import InputError

    if threads is not None:
        try:
            numba.set_num_threads(threads)
        except ValueError:
            raise InputError(f"--threads {threads}: this machine has {numba.get_num_threads()}") from None


@contextlib.contextmanager
def _progress(begin: str) -> Any:
    """Show a bar with the time left on a terminal, and nothing elsewhere; yield what sets it."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

    console = Console(stderr=True)
    if not console.is_terminal:
        yield lambda *_: None
        return
    columns = (
        BarColumn(), TextColumn("{task.percentage:3.0f} %"), TextColumn("{task.description}"),
        TimeElapsedColumn(), TextColumn("left"), TimeRemainingColumn(),
    )  # fmt: skip
    with Progress(*columns, console=console, transient=True) as progress:
        task = progress.add_task(begin, total=1.0)
        yield lambda share, going_on: progress.update(task, completed=share, description=going_on)


def _console() -> Any:
    """Return where results are printed: as wide as the terminal, or wide enough for any table where there is none."""
    from rich.console import Console

    return Console(width=None if sys.stdout.isatty() else 120, highlight=False)


def _print_summary(run: "Run") -> None:
    """Print a table of the snapshots and how the run ended."""
    from rich.table import Table

    meshed = run.results.elements > 0
    heads = ("length", "foot r", "greatest r", "velocity", "kinetic", "impulse", "hourglass", "ledger", "lost")
    units = ("mm", "mm", "mm", "m/s", "mJ", "N ms", "mJ", "%", "elements" if meshed else "points")
    table = Table("time\nus", *(f"{head}\n{unit}" for head, unit in zip(heads, units, strict=True)), box=None)
    for column in table.columns:
        column.justify = "right"
    for row in run.rows:
        ledger = 100.0 * row.numerical / run.results.initial_energy
        table.add_row(
            f"{row.time * 1e3:g}", f"{row.length:.3f}", f"{row.foot_radius:.3f}", f"{row.greatest_radius:.3f}",
            f"{row.velocity:.2f}", f"{row.kinetic:.1f}", f"{row.wall_impulse:.2f}", f"{row.hourglass:.1f}",
            f"{ledger:+.2f}", str(row.lost),
        )  # fmt: skip
    console = _console()
    if run.case.title:
        console.print(run.case.title, markup=False)
    console.print(table)
    console.print(_ending(run), markup=False, soft_wrap=True)


def _ending(run: "Run") -> str:
    """Say in a sentence how a run ended and where it is."""
    results = run.results
    if run.status == "running":
        return f"not finished: still running, or killed; {run.folder}"
    parts = results.elements or results.points
    pace = parts * max(results.steps - 1, 0) / max(results.wall_time, 1e-3) / 1e6
    gone = run.rows[-1].lost if run.rows else 0
    lost = f", {gone} {'elements deleted' if results.elements else 'points left the box'}" if gone else ""
    ended = "complete" if run.status == "complete" else f"INCOMPLETE ({results.reason})"
    kind = "element" if results.elements else "point"
    work = f"{parts} {kind}s, {results.steps} steps in {results.wall_time:.2f} s"
    ledger = f"ledger within {results.energy_error:.2f} % of the initial kinetic energy"
    mesh = ""
    if results.mesh:
        mesh = (
            f"mesh: {results.points} nodes, least scaled Jacobian {results.mesh.least_jacobian:.2f}, greatest aspect "
            f"{results.mesh.greatest_aspect:.2f}\n"
        )
    return f"{mesh}{ended}: {work} ({pace:.1f} M {kind}-steps/s), {ledger}{lost}\n{run.folder}"
