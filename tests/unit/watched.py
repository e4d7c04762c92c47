"""Code for new processes that says which compiled code was made there, and which came from the disk."""

import functools
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import viscopoint

PACKAGE = Path(viscopoint.__file__).parent
WATCH = """
import re
from viscopoint.kernels.cache import Cache
load, compiled, loaded, files = Cache.load_overload, [], [], []
def watched(cache, *words):
    found = load(cache, *words)
    files.append(str(cache._file(words[0])))
    name = re.sub("_[0-9a-f]{8}$", "", cache._name.rpartition(".")[2])  # blocks are told apart by their classes' parts
    (loaded if found else compiled).append(name)
    return found
Cache.load_overload = watched
"""

# stored energy of a point of which J = 0.9, by MATERIAL: a kernel that knows no material, and a material's three blocks
ENERGY = (
    WATCH
    + """
import numpy as np
from viscopoint.kernels.slabs import CHUNKS
from viscopoint.materials.block import MaterialBlock
from viscopoint.materials.elastic import Elastic
from viscopoint.model.points import STORED_ENERGY, SUMS, material_at_rest, sum_energies, volume_at_rest
block = MaterialBlock(MATERIAL)
state, shared, sums = material_at_rest(block, 1), volume_at_rest(1), np.empty((CHUNKS, SUMS))
shared.jacobian[:] = 0.9
sum_energies(state, shared, np.ones(1), block.code, sums)
print(sums[:, STORED_ENERGY].sum(), len(loaded), *sorted(compiled))
"""
)
ELASTIC = ENERGY.replace("MATERIAL", "Elastic(1e-3, 100.0, 10.0)")
BLOCKS = ["energies_Elastic__", "prepare_Elastic__", "update_Elastic__"]
ALL = sorted([*BLOCKS, "sum_energies"])

# a kernel that is compiled in no time, where any will do
ZERO = (
    WATCH
    + """
import numpy as np
from viscopoint.methods.mpm.grid import zero
field = np.ones((1, 4))
zero(field)
print(field.sum(), len(loaded), *sorted(compiled))
"""
)


def start(code: str, package: Path, **settings: str | Path) -> subprocess.Popen[str]:
    """Start code in a new process on a copy of the package, with settings of its own."""
    environment = {key: value for key, value in os.environ.items() if key != "VISCOPOINT_CACHE"}
    environment |= {"PYTHONPATH": str(package.parent), **{key: str(value) for key, value in settings.items()}}
    return subprocess.Popen([sys.executable, "-B", "-c", code], env=environment, stdout=subprocess.PIPE, text=True)


def told(process: subprocess.Popen[str]) -> list[str]:
    """Return the words that a process printed."""
    out, _ = process.communicate()
    assert process.returncode == 0
    return out.split()


def run_python(code: str, package: Path, cache: Path) -> list[str]:
    """Return the words that code prints in a new process on a copy of the package."""
    return told(start(code, package, VISCOPOINT_CACHE=cache))


@functools.cache
def compile_elastic(cache: Path) -> str:
    """Fill an empty cache with the code of ``ELASTIC``; return the energy."""
    cold, loaded, *compiled = run_python(ELASTIC, PACKAGE, cache)
    assert (loaded, compiled) == ("0", ALL)
    return cold


def fill(cache: Path, folders: pytest.TempPathFactory) -> str:
    """Fill an empty cache with the code of ``ELASTIC``, compiled once for all tests; return the energy."""
    compiled = folders.getbasetemp() / "elastic"
    cold = compile_elastic(compiled)
    shutil.copytree(compiled, cache)
    return cold
