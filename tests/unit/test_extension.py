"""What CONTRIBUTING adds to the package, a new file each, works as it is printed there."""

import functools
import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import viscopoint
from viscopoint.kernels.cache_folder import cache_folder
from viscopoint.results.output import history

PACKAGE = Path(viscopoint.__file__).parent
CONTRIBUTING = PACKAGE.parent.parent / "CONTRIBUTING.md"
FILES = (  # of its examples, in their order
    "materials/maxwell.py", "methods/mpm/shapes/hat.py", "methods/fem/elements/free.py", "results/output/steps.py",
    "figures/steps.py",
)  # fmt: skip


@pytest.fixture(scope="module")
def extended(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the package with all the files that CONTRIBUTING adds."""
    copy = tmp_path_factory.mktemp("extended") / "viscopoint"
    shutil.copytree(PACKAGE, copy, ignore=shutil.ignore_patterns("__pycache__"))
    examples = re.findall(r"```python\n(.*?)```", CONTRIBUTING.read_text(), re.S)
    for file, text in zip(FILES, examples, strict=True):
        assert not (copy / file).exists()
        (copy / file).write_text(text)
    return copy


STANDARD = 'density="1 g/cm^3", bulk="550 MPa", decay="650 1/ms"'
MAXWELL = f'{{law="maxwell", shear="140 MPa", {STANDARD}}}'
NO_SPRING = f'{{law="linear-viscoelastic", shear_short="140 MPa", shear_long="0 MPa", {STANDARD}}}'
CASE = {"method.cell": "1 mm", "method.spacing": "0.72 mm", "time.snapshots": "[]", "time.end": "1 us"}
FEM = {"method.size": "1.9 mm", "time.snapshots": "[]", "time.end": "5 us"}


def environment(package: Path) -> dict[str, str]:
    """Return that of a process which uses a package."""
    ours = {} if package == PACKAGE else {"VISCOPOINT_CACHE": str(package.parent / "cache")}
    return os.environ | {"PYTHONPATH": str(package.parent)} | ours


def python(package: Path, *words: str) -> str:
    """Return what a new process prints with a package."""
    done = subprocess.run([sys.executable, *words], env=environment(package), capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


@functools.cache
def kernels_of(package: Path) -> Path:
    """Return a package's folder of compiled code."""
    code = "from viscopoint.kernels.cache_folder import cache_folder; print(cache_folder())"
    return Path(python(package, "-c", code).strip())


def run(package: Path, folder: Path, changes: dict[str, str], *words: str) -> Path:
    """Run a small case with a package, in a new process; return its run folder.

    A copy is lent what is compiled: it has the same sources and more files, and compiles only what uses those.
    """
    for code in cache_folder().glob("*.code") if package != PACKAGE else ():
        shutil.copy2(code, kernels_of(package))
    settings = [word for key, value in changes.items() for word in ("--set", f"{key}={value}")]
    python(package, "-m", "viscopoint", "run", "paper", "--out", str(folder), *words, *settings)
    return folder


def velocity(folder: Path) -> float:
    """Return the velocity of the centre of mass at the end."""
    return json.loads((folder / "summary.json").read_text())["snapshots"][-1]["velocity"]


def test_a_material(extended: Path, tmp_path: Path):
    # a standard linear solid without its spring is the same fluid
    known = velocity(run(PACKAGE, tmp_path / "known", CASE | {"material": NO_SPRING}, "--no-figures"))
    added = velocity(run(extended, tmp_path / "added", CASE | {"material": MAXWELL}, "--no-figures"))
    assert -149.0 < known < -100.0
    assert abs(added - known) < 1e-9


def test_a_shape_function_an_output_and_a_figure(extended: Path, tmp_path: Path):
    known = run(PACKAGE, tmp_path / "known", CASE | {"method.shape": "trilinear"}, "--no-figures")
    added = run(extended, tmp_path / "added", CASE | {"method.shape": "hat"})
    assert -149.0 < velocity(known) < -100.0
    assert abs(velocity(added) - velocity(known)) < 1e-9
    steps = [float(line) for line in (added / "steps.txt").read_text().split()]
    assert steps == history.read(added / "history.csv")["time_step"].tolist()
    assert (added / "figures" / "steps.png").read_bytes().startswith(b"\x89PNG")


def test_an_element(extended: Path, tmp_path: Path):
    words = ("--method", "fem", "--no-figures")
    nothing = {"method.hourglass.form": "viscous", "method.hourglass.coefficient": "0.0"}
    known = run(PACKAGE, tmp_path / "known", FEM | nothing, *words)
    added = run(extended, tmp_path / "added", FEM | {"method.element": "free"}, *words)
    assert abs(velocity(added) - velocity(known)) < 1e-9
    controlled = run(PACKAGE, tmp_path / "controlled", FEM, *words)
    assert abs(velocity(added) - velocity(controlled)) > 1e-6


def test_an_output_goes_on_from_a_checkpoint(extended: Path, tmp_path: Path):
    code = f"""
import sys
import viscopoint as vp
def end(share, row):
    if share > 0.5: raise KeyboardInterrupt
case = vp.Case.load("paper", {CASE | {"time.snapshots": []}!r})
where, whole = {str(tmp_path / "cut")!r}, {str(tmp_path / "whole")!r}
vp.run(case, where, figures=False, checkpoint_every="0.2 us simulated", watch=end)
vp.resume(where, figures=False)
vp.run(case, whole, figures=False)
"""
    python(extended, "-c", code)
    assert (tmp_path / "cut" / "steps.txt").read_text() == (tmp_path / "whole" / "steps.txt").read_text()
