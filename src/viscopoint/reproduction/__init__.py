"""Reproduces the paper: its figures by both methods, what they show, and how well the methods agree.

Runs that are there already, of the same case and version, are taken as they are.
"""

import itertools
import time
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from viscopoint.arguments import checked
from viscopoint.case.case import Case
from viscopoint.errors import InputError, nearest
from viscopoint.reproduction import agreement, decoding, deviations
from viscopoint.reproduction.agreement import Agreement
from viscopoint.reproduction.cases import RESOLUTIONS, main_cases, printed_cases
from viscopoint.reproduction.deviations import Deviation
from viscopoint.reproduction.figures import FIGURES, save
from viscopoint.reproduction.pool import Pool, Watch
from viscopoint.reproduction.statements import STATEMENTS, Finding, Statement
from viscopoint.results.folder import alone, disk_faults, make, whole, write_json
from viscopoint.results.run import Run

Runs = dict[str, Run]
NAME = "reproduction.json"
EXPLAINING_DPI = 160
EXPLAINING: dict[str, Callable[[dict[str, Runs]], Any]] = {  # figures of the report that are not the paper's
    "units": lambda runs: decoding.units_figure(runs["paper"]),
    "deviations": lambda runs: deviations.figure(runs["paper"], runs["causes"]),
}


@dataclass
class Reproduction:
    """What was made and found."""

    folder: Path
    resolution: str
    runs: dict[str, Runs]  # by resolution, then by name; "causes" has those of the deviations
    figures: dict[str, Path] = field(default_factory=dict)
    findings: list[tuple[Statement, Finding]] = field(default_factory=list)
    agreement: dict[str, list[Agreement]] = field(default_factory=dict)  # by resolution
    deviations: list[Deviation] = field(default_factory=list)
    report: Path | None = None
    wall_time: float = 0.0  # s

    def to_tables(self) -> dict[str, Any]:
        """Return all numbers under names, as ``reproduction.json`` holds them."""
        return {
            "format": 1,
            "resolution": self.resolution,
            "wall_time [s]": round(self.wall_time, 1),
            "statements": [
                {"figure": said.figure, "statement": said.words, "seen": found.seen, "measured": found.measured}
                for said, found in self.findings
            ],
            "agreement": {name: [row.to_table() for row in rows] for name, rows in self.agreement.items()},
            "deviations": [row.to_table() for row in self.deviations],
        }


@checked
def reproduce(
    out: str | Path, only: Collection[str] = (), resolution: str = "paper", watch: Watch | None = None
) -> Reproduction:
    """Run what is missing, draw the paper's figures, check its statements, and write the report.

    Args:
        out: the folder for runs, figures and report; one of an earlier reproduction is completed.
        only: names of figures, such as "fig5": draw these alone, from the runs they need, without a report.
        resolution: "paper", or "fine" for half the paper's distances, beside the paper's.
        watch: called with the share of the runs done and the names of those going on.

    Raises:
        InputError: there is no such figure or resolution, or the folder holds something else.
        ViscopointError: a run did not end as it should; what is finished stays and is taken the next time.
    """
    began = time.perf_counter()
    for name in only:
        if name not in FIGURES:
            raise InputError(f"figure '{name}' is not known; {nearest(name, FIGURES)}")
    if resolution not in RESOLUTIONS:
        raise InputError(f"resolution '{resolution}' is not known; {nearest(resolution, RESOLUTIONS)}")
    folder = Path(out)
    make(folder, NAME)
    cases = _cases(only, resolution)
    with alone(folder), disk_faults(folder), Pool(len(cases)) as pool:
        made = Reproduction(folder, resolution, _sorted(pool.finish(cases, folder / "runs", watch)))
        if watch:
            watch(1.0, "figures and numbers")
        wait_for_figures = _draw(made, only, pool)
        _find(made, only)
        wait_for_figures()
        if not only:
            _write_report(made)
        made.wall_time = time.perf_counter() - began
        if not only:
            write_json(folder / NAME, made.to_tables())
    return made


def _cases(only: Collection[str], resolution: str) -> dict[str, Case]:
    """Return the cases to run, by the folder of their runs."""
    shown = {f"{resolution}/{name}": case for name, case in main_cases(resolution)}
    if only:
        needed = {name for figure in only for name in FIGURES[figure].needs}
        needed |= {name for said in STATEMENTS if said.figure in only for name in said.needs}
        return {name: case for name, case in shown.items() if name.partition("/")[2] in needed}
    own = {f"paper/{name}": case for name, case in main_cases("paper")}
    causes = {f"causes/{name}": case for name, case in deviations.cases()}
    printed = {f"paper/{name}": case for name, case in printed_cases()}
    # first one by each method, so that no two workers compile the same; then what takes longest
    first = dict(itertools.islice(own.items(), 2))
    return first | (shown if resolution != "paper" else {}) | causes | own | printed


def _sorted(finished: Mapping[str, Run]) -> dict[str, Runs]:
    runs: dict[str, Runs] = {}
    for place, run in finished.items():
        group, _, name = place.partition("/")
        runs.setdefault(group, {})[name] = run
    return runs


def _draw(made: Reproduction, only: Collection[str], pool: Pool) -> Callable[[], None]:
    """Begin to draw the paper's figures, and with the report those that explain; return what waits for the end."""
    figures = made.folder / "figures" / made.resolution
    figures.mkdir(parents=True, exist_ok=True)
    names = [name for name in FIGURES if name in only] if only else [*FIGURES, *EXPLAINING]
    made.figures = {name: figures / f"{name}.png" for name in names}
    folders = {group: {name: run.folder for name, run in runs.items()} for group, runs in made.runs.items()}
    return pool.begin(_draw_one, [(name, folders, made.resolution, file) for name, file in made.figures.items()])


def _draw_one(name: str, folders: dict[str, dict[str, Path]], resolution: str, file: Path) -> None:
    """Draw one figure in a worker."""
    from matplotlib import rc_context

    from viscopoint.figures import STYLE

    runs = {group: {inner: Run(folder) for inner, folder in inside.items()} for group, inside in folders.items()}
    if name in FIGURES:
        save(FIGURES[name].draw(runs[resolution]), file)
        return
    with rc_context(STYLE):
        drawn = EXPLAINING[name](runs)
        with whole(file) as part:
            drawn.savefig(part, format="png", dpi=EXPLAINING_DPI)


def _find(made: Reproduction, only: Collection[str]) -> None:
    """Check what the paper says; unless a figure alone is wanted, measure what it does not say."""
    runs = made.runs[made.resolution]
    said = [statement for statement in STATEMENTS if not only or statement.figure in only]
    made.findings = [(it, it.check({name: runs[name] for name in it.needs})) for it in said]
    if not only:
        mains = [name for name in RESOLUTIONS if name in made.runs]
        made.agreement = {name: agreement.agreements(made.runs[name]) for name in mains}
        made.deviations = deviations.measured(made.runs["paper"], made.runs["causes"])


def _write_report(made: Reproduction) -> None:
    from viscopoint.report.page import write_page
    from viscopoint.reproduction.page import page

    made.report = made.folder / "report.html"
    write_page(page(made), made.report)
