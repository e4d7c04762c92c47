import re
import tomllib
from pathlib import Path

from viscopoint.kernels import promise
from viscopoint.results import provenance


def test_versions_are_recorded_of_packages_that_an_installation_has():
    table = tomllib.loads((Path(__file__).parents[2] / "pyproject.toml").read_text())
    needed = {re.split(r"[<>=~!\[; ]", line)[0] for line in table["project"]["dependencies"]}
    assert {*promise.PACKAGES, *provenance.PACKAGES} <= needed | {"llvmlite"}  # which Numba brings
