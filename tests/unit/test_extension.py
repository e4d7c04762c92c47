import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import viscopoint

PACKAGE = Path(viscopoint.__file__).parent
CONTRIBUTING = PACKAGE.parent.parent / "CONTRIBUTING.md"


STANDARD = 'density="1 g/cm^3", bulk="550 MPa", decay="650 1/ms"'
MAXWELL = f'law="maxwell", shear="140 MPa", {STANDARD}'
NO_SPRING = f'law="linear-viscoelastic", shear_short="140 MPa", shear_long="0 MPa", {STANDARD}'


CASE = {"method.cell": "1 mm", "method.spacing": "0.72 mm", "time.snapshots": "[]", "time.end": "1 us"}


def velocity_after_impact(package: Path, material: str, place: Path, cache: dict[str, str]) -> float:
    """Run a small case with a package; return the velocity of the centre of mass at the end."""
    changes = CASE | {"material": f"{{{material}}}"}
    settings = [word for key, value in changes.items() for word in ("--set", f"{key}={value}")]
    command = [sys.executable, "-m", "viscopoint", "run", "paper", "--out", str(place / "run"), "--no-figures"]
    environment = os.environ | {"PYTHONPATH": str(package.parent)} | cache
    done = subprocess.run([*command, *settings, "--force"], env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return json.loads((place / "run" / "summary.json").read_text())["snapshots"][-1]["velocity"]


def test_the_law_that_contributing_adds_works_as_one_new_file(tmp_path: Path):
    copy = tmp_path / "viscopoint"
    shutil.copytree(PACKAGE, copy, ignore=shutil.ignore_patterns("__pycache__"))
    blocks = re.findall(r"```python\n(.*?)```", CONTRIBUTING.read_text(), re.S)
    (copy / "materials" / "maxwell.py").write_text(blocks[0])
    added = velocity_after_impact(copy, MAXWELL, tmp_path, {"VISCOPOINT_CACHE": str(tmp_path / "cache")})
    # a standard linear solid without its spring is the same fluid
    known = velocity_after_impact(PACKAGE, NO_SPRING, tmp_path, {})
    assert -149.0 < known < -100.0
    assert abs(added - known) < 1e-9
