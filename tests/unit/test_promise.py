"""The same bits are promised for the same software, processor and settings; of others one is told."""

import json
import shutil
import warnings
from pathlib import Path
from typing import Any

import numba
import numpy as np
import pytest
from typer.testing import CliRunner

import viscopoint as vp
from viscopoint.command_line.cli import app
from viscopoint.kernels.promise import KEYS, differences, promise


def rewritten(folder: Path, **changes: Any) -> None:
    """Change entries of a run's provenance; None removes one."""
    data = json.loads((folder / "provenance.json").read_text()) | changes
    kept = {key: value for key, value in data.items() if value is not None}
    (folder / "provenance.json").write_text(json.dumps(kept))


@pytest.fixture
def cut(quick: vp.Case, tmp_path: Path) -> Path:
    """The folder of a run that was interrupted."""

    def end(share: float, row: object) -> None:
        if share > 0.5:
            raise KeyboardInterrupt

    vp.run(quick, tmp_path / "cut", figures=False, checkpoint_every="0.2 us simulated", watch=end)
    return tmp_path / "cut"


def test_provenance_has_all_that_bits_depend_on(finished: Path):
    recorded = vp.Run(finished).provenance
    assert set(KEYS) <= set(recorded)
    assert (recorded["numba"], recorded["numpy"]) == (numba.__version__, np.__version__)
    assert recorded["numba_settings"]["OPT"] == 3
    assert recorded["cpu"]
    assert differences(recorded, promise()) == []


CHANGES = [
    ({"numba": "0.1"}, f"numba: 0.1, now {numba.__version__}"),
    ({"numpy": "1.0"}, f"numpy: 1.0, now {np.__version__}"),
    ({"llvm": "3.1.0"}, "llvm: 3.1.0, now "),
    ({"python": "3.1"}, "python: 3.1, now "),
    ({"cpu": "i386"}, "cpu: i386, now "),
    ({"cpu_features": promise()["cpu_features"] + " x87"}, "cpu_features: now without x87"),
    ({"numba_settings": promise()["numba_settings"] | {"OPT": 0}}, "numba_settings: OPT 0, now 3"),
]


@pytest.mark.parametrize(("change", "words"), CHANGES)
def test_resuming_elsewhere_tells_what_differs_and_records_it(change: dict[str, Any], words: str, cut: Path):
    rewritten(cut, **change)
    with pytest.warns(vp.ViscopointWarning, match="last bits") as caught:
        run = vp.resume(cut, figures=False)
    assert words in str(caught[0].message)
    assert run.status == "complete"
    assert len(run.provenance["resumed_with"]) == 1
    assert run.provenance["resumed_with"][0].startswith(words)


def test_the_command_line_tells_it_too_in_one_line_and_goes_on(cut: Path):
    rewritten(cut, numba="0.1\n\x1b[2J")
    with warnings.catch_warnings():
        warnings.simplefilter("always")  # as outside of tests
        result = CliRunner().invoke(app, ["resume", str(cut), "--no-figures"])
    assert result.exit_code == 0
    assert "numba: 0.1\\n\\x1b[2J, now" in result.stderr


def test_a_run_of_before_these_entries_is_resumed_without_a_word(cut: Path):
    new = ("llvm", "libc", "cpu", "cpu_features", "numba_settings")
    rewritten(cut, **dict.fromkeys(new))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert vp.resume(cut, figures=False).provenance["resumed_with"] == []


def test_verifying_lists_what_differs(finished: Path, tmp_path: Path):
    folder = tmp_path / "run"
    shutil.copytree(finished, folder)
    rewritten(folder, llvm="3.1.0", cpu="i386", resumed_with=["numba: 0.1, now 0.2"])
    result = CliRunner().invoke(app, ["verify", str(folder)])
    assert result.exit_code == 0
    lines = result.stdout.splitlines()
    assert lines[0].startswith("the same: ")
    for words in ("llvm: 3.1.0, now ", "cpu: i386, now ", "when it was resumed, numba: 0.1, now 0.2"):
        assert any(line.startswith(words) for line in lines)
