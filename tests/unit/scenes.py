"""What tests of the report's page and of its 3-D view show."""

from pathlib import Path

import pytest

import viscopoint as vp
from viscopoint.report.scene import Scene, scene_of


@pytest.fixture(scope="module", name="runs")
def runs_side_by_side(finished: Path, finished_fem: Path) -> dict[tuple[str, str], vp.Run]:
    """Runs by the names of their material and method."""
    return {("soft", "FEM"): vp.Run(finished_fem), ("soft", "MPM"): vp.Run(finished)}


@pytest.fixture(scope="module", name="scene")
def scene_of_runs(runs: dict[tuple[str, str], vp.Run]) -> Scene:
    return scene_of(runs)
