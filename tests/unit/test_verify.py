import shutil
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from typer.testing import CliRunner

import viscopoint as vp
from viscopoint.command_line.cli import app
from viscopoint.results.output.fields import file_of
from viscopoint.results.verify import _difference, verify


def test_a_run_verified_has_the_same_bits(finished: Path):
    result = CliRunner().invoke(app, ["verify", str(finished)])
    assert result.exit_code == 0
    assert result.stdout.startswith("the same: ")


def test_the_last_bit_of_one_number_is_found(finished: Path, tmp_path: Path):
    folder = tmp_path / "run"
    shutil.copytree(finished, folder)
    with h5py.File(file_of(folder, 2), "r+") as file:
        stress: Any = file["VTKHDF/PointData/stress"]
        stress[-1, 2] = np.nextafter(stress[-1, 2], 0.0)
    verdict = verify(folder)
    assert [(found.place, found.numbers) for found in verdict.differences] == [("stress at 2 us", 1)]
    result = CliRunner().invoke(app, ["verify", str(folder)])
    assert result.exit_code == 1
    assert "stress at 2 us: 1 numbers differ" in result.stdout


@pytest.mark.parametrize(("one", "other"), [(0.0, -0.0), (np.nan, -np.nan), (1.0, np.nextafter(1.0, 2.0))])
def test_numbers_are_the_same_if_their_bits_are(one: float, other: float):
    assert _difference("x", np.array([[1.0, one]]), np.array([[1.0, one]])) is None
    found = _difference("x", np.array([[1.0, one]]), np.array([[1.0, other]]))
    assert found is not None
    assert found.numbers == 1


def test_an_unfinished_run_cannot_be_verified(quick: vp.Case, tmp_path: Path):
    def end(share: float, row: object) -> None:
        raise KeyboardInterrupt

    vp.run(quick, tmp_path / "run", figures=False, watch=end)
    with pytest.raises(vp.InputError, match="not finished"):
        verify(tmp_path / "run")
