"""One small run by each method, and by the command line: also with the lowest versions of what we depend on."""

from pathlib import Path

import pytest
from typer.testing import CliRunner

import viscopoint as vp
from viscopoint.command_line.cli import app

DISTANCE = {"mpm": ("spacing", "cell"), "fem": ("size",), "tlmpm": ("spacing",)}


@pytest.mark.parametrize("method", DISTANCE)
def test_a_rod_loses_the_momentum_that_the_wall_takes(method: str, tmp_path: Path):
    distance = {f"method.{key}": "1 mm" for key in DISTANCE[method]}
    settings = {"time.end": "4 us", "time.snapshots": "[]", "method.geometry": "axisymmetric", **distance}
    changes = [word for key, value in settings.items() for word in ("--set", f"{key}={value}")]
    words = ["run", "paper", "--method", method, "--out", str(tmp_path / "run"), *changes]
    result = CliRunner().invoke(app, words)
    assert result.exit_code == 0, result.output
    run = vp.Run(tmp_path / "run")
    start, end = run.rows[0], run.rows[-1]
    mass = 2.0 * start.kinetic / start.velocity**2  # g, all at one speed
    assert end.wall_impulse > 10.0
    assert end.wall_impulse == pytest.approx(mass * (end.velocity - start.velocity), rel=1e-9)
    assert run.snapshot("4 us")["stress"].shape[1] == 6
    assert {figure.name for figure in (tmp_path / "run" / "figures").iterdir()}
