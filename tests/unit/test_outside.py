"""Materials that users keep in files of their own: never run stale, and no trouble for those who do not have them."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from watched import ALL, BLOCKS, ELASTIC, ENERGY, fill

from viscopoint.kernels.cache_folder import cache_folder

MATERIAL = """
from typing import Literal, NamedTuple
from viscopoint.case.tables import MaterialInput
from viscopoint.kernels.jit import implements
from viscopoint.materials import Response, shear_energy, step_factors, stored_energy, update_stress
from viscopoint.kernels.logarithm import log
from viscopoint.kernels.tensors import spherical
from viscopoint.case.units import Density, PositiveModulus
from numbers_of_mine import FACTOR

class Mine(NamedTuple):
    density: float
    bulk: float

    @property
    def p_wave_modulus(self): return self.bulk
    @property
    def history_fields(self): return ()

class MineInput(MaterialInput):
    law: Literal["mine"]
    density: Density
    bulk: PositiveModulus
    def build(self): return Mine(self.density, self.bulk)

@implements(step_factors, Mine)
def factors(material, dt): return 0.0

@implements(update_stress, Mine)
def update(material, factors, increment, stress, history):
    return Response(spherical(FACTOR * material.bulk * log(increment.jacobian)), history, 0.0, material.bulk)

@implements(stored_energy, Mine)
def energy(material, jacobian, stress, history): return FACTOR * material.bulk

@implements(shear_energy, Mine)
def shear(material, stress, history): return 0.0
"""

MINE = "import material_of_mine\n" + ENERGY.replace("MATERIAL", "material_of_mine.Mine(1e-3, 3.0)")
BLOCKS_OF_MINE = ["energies_Mine__", "prepare_Mine__", "update_Mine__"]


def write_material(place: Path, factor: float) -> None:
    (place / "material_of_mine.py").write_text(MATERIAL)
    (place / "numbers_of_mine.py").write_text(f"FACTOR = {factor}\n")


def python(code: str, place: Path, **settings: str) -> str:
    """Run code in a new process that finds the modules in a folder, and its cache."""
    path = os.pathsep.join([str(place), *sys.path])
    environment = os.environ | {"PYTHONPATH": path, "VISCOPOINT_CACHE": str(place / "cache")} | settings
    done = subprocess.run([sys.executable, "-B", "-c", code], env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


def kept(place: Path) -> set[str]:
    """Return the names of what is compiled on the disk."""
    return {file.name.partition("-")[0].rpartition(".")[2] for file in (place / "cache").rglob("*.code")}


def test_an_edited_material_from_outside_is_not_run_stale_and_others_never_see_it(tmp_path: Path):
    write_material(tmp_path, 1.0)
    assert python(MINE, tmp_path).split() == ["3.0", "0", *sorted([*BLOCKS_OF_MINE, "sum_energies"])]
    write_material(tmp_path, 2.0)
    assert python(MINE, tmp_path).split() == ["6.0", "1", *BLOCKS_OF_MINE]  # the kernel knows no material
    assert kept(tmp_path) == {"sum_energies"}
    for name in ("material_of_mine.py", "numbers_of_mine.py"):
        (tmp_path / name).unlink()
    cold, *others = python(ELASTIC, tmp_path).split()
    assert others == ["1", *BLOCKS]
    assert python(ELASTIC, tmp_path).split() == [cold, str(len(ALL))]


REPLACED = """
from viscopoint.kernels.jit import implements
from viscopoint.materials import stored_energy
from viscopoint.materials.elastic import Elastic

@implements(stored_energy, Elastic)
def energy(material, jacobian, stress, history): return 7.0
"""


def test_one_of_our_materials_that_somebody_changes_stays_as_it_is_for_others(
    tmp_path: Path, tmp_path_factory: pytest.TempPathFactory
):
    ours = fill(tmp_path / "cache", tmp_path_factory)
    (tmp_path / "change.py").write_text(REPLACED)
    assert python("import change\n" + ELASTIC, tmp_path).split() == ["7.0", "0", *ALL]
    assert python(ELASTIC, tmp_path).split() == [ours, str(len(ALL))]


CASE = """
import material_of_mine, sys
import viscopoint as vp
def stop(share, row):
    if share > 0.5: raise KeyboardInterrupt
"""
BEGIN = (
    CASE
    + """
material = {"law": "mine", "density": "1 g/cm^3", "bulk": "550 MPa"}
method = {"name": "fem", "geometry": "axisymmetric", "size": "1 mm"}
case = vp.Case.load("paper").with_(material=material, method=method, time={"end": "2 us", "snapshots": []})
vp.run(case, "RUN", figures=False, checkpoint_every="never", watch=stop)
"""
)
RESUME = (
    CASE
    + """
try:
    print(vp.resume("RUN", figures=False).status)
except vp.InputError as error:
    print(error)
"""
)


def test_a_run_is_not_resumed_with_an_edited_material_from_outside(tmp_path: Path):
    write_material(tmp_path, 1.0)
    begin, resume = (code.replace("RUN", str(tmp_path / "run")) for code in (BEGIN, RESUME))
    ours = {"VISCOPOINT_CACHE": str(cache_folder().parent)}  # what it says of kernels is tested above
    python(begin, tmp_path, **ours)
    write_material(tmp_path, 2.0)
    assert "begun by other sources" in python(resume, tmp_path, **ours)
    write_material(tmp_path, 1.0)
    assert python(resume, tmp_path, **ours).strip() == "complete"


def test_a_material_that_is_not_used_does_not_count(tmp_path: Path):
    write_material(tmp_path, 1.0)
    code = "import viscopoint as vp\nfrom viscopoint.kernels.sources import digest\n"
    code += "from viscopoint.results.provenance import sources_of\n"
    code += "print(sources_of(vp.Case.load('paper')) == digest())"
    assert python("import material_of_mine\n" + code, tmp_path).strip() == "True"


def test_a_material_that_is_in_no_file_counts_as_another_in_each_process(tmp_path: Path):
    write_material(tmp_path, 1.0)
    code = f"{MATERIAL}\nimport viscopoint as vp\nfrom viscopoint.results.provenance import sources_of\n"
    code += "material = {'law': 'mine', 'density': '1 g/cm^3', 'bulk': '550 MPa'}\n"
    code += "print(sources_of(vp.Case.load('paper').with_(material=material)))"
    assert len({python(code, tmp_path) for _ in range(2)}) == 2
