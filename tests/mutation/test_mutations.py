"""Every change in ``mutations.MUTATIONS`` makes the tests that it names fail; see there."""

import os
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from mutations import MUTATIONS, Mutation

import viscopoint

PACKAGE = Path(viscopoint.__file__).parent
TESTS = Path(__file__).parents[1]
FAILED = 1  # pytest's code for tests that failed; others are for tests that could not be read, or none chosen
each_mutation = pytest.mark.parametrize("mutation", MUTATIONS, ids=[mutation.name for mutation in MUTATIONS])


@each_mutation
def test_the_list_is_true(mutation: Mutation) -> None:
    text = (PACKAGE / mutation.file).read_text()
    assert text.count(mutation.old) == 1
    assert mutation.new not in text
    assert (TESTS / shlex.split(mutation.tests)[0]).is_file()


@pytest.mark.long
@each_mutation
def test_a_changed_line_is_noticed(mutation: Mutation, tmp_path: Path) -> None:
    package = tmp_path / "src" / "viscopoint"
    shutil.copytree(PACKAGE, package, ignore=shutil.ignore_patterns("__pycache__"))
    changed = package / mutation.file
    changed.write_text(changed.read_text().replace(mutation.old, mutation.new))
    environment = {**os.environ, "PYTHONPATH": str(package.parent), "VISCOPOINT_CACHE": str(tmp_path / "kernels")}
    words = [sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", *shlex.split(mutation.tests)]
    done = subprocess.run(words, env=environment, cwd=TESTS, capture_output=True, text=True, check=False)
    shutil.rmtree(tmp_path / "kernels", ignore_errors=True)
    assert done.returncode == FAILED, f"{mutation.file}: no test noticed\n{done.stdout[-3000:]}{done.stderr[-2000:]}"
