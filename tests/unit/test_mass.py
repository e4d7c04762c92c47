"""The mass that is computed is the rod's, or the result says that it is not, or there is none."""

import math
from pathlib import Path

import numpy as np
import pytest

import viscopoint as vp
from viscopoint.model.build import build

ROD = 1e-3 * math.pi * 3.8**2 * 25.4  # g, of the paper
LATTICE = {"method.fill": "lattice", "method.cell": "2.6 mm", "time.end": "1 us", "time.snapshots": []}


def mass_of(case: vp.Case) -> float:
    return float(build(case).method.totals().mass)


@pytest.mark.parametrize("size", ["0.38 mm", "1.2 mm", "1.9 mm", "3.8 mm"])
def test_a_mesh_of_any_size_has_the_rod_s_mass(size: str):
    # a polygon of 8 corners on the circle would lack 10 %; float of sums over some thousand volumes
    assert mass_of(vp.Case.load("paper", {}, method="fem").with_({"method.size": size})) == pytest.approx(
        ROD, rel=1e-12
    )


@pytest.mark.parametrize("geometry", ["3d", "axisymmetric"])
@pytest.mark.parametrize("method", ["mpm", "tlmpm", "fem"])
def test_the_usual_choices_of_each_method_have_the_rod_s_mass(method: str, geometry: str):
    tables = vp.Case.load("paper").to_tables() | {"method": {"name": method, "geometry": geometry}}
    resolution = {"size": "0.7 mm"} if method == "fem" else {"spacing": "0.7 mm"}
    cell = {"cell": "1.4 mm"} if method == "mpm" else {}
    case = vp.Case.from_tables(tables | {"method": tables["method"] | resolution | cell})
    assert mass_of(case) == pytest.approx(ROD, rel=1e-12)


def test_the_paper_s_lattice_is_heavier_than_its_rod_and_says_so(tmp_path: Path):
    case = vp.Case.load("paper", {"time.end": "1 us", "time.snapshots": []})
    with pytest.warns(vp.ResultWarning, match=r"mass, 1\.162 g, is \+0\.82 % off that of the rod, 1\.152 g"):
        run = vp.run(case, tmp_path / "run", figures=False)
    lattice = 1e-3 * 21_172 * 0.38**3
    assert run.summary["mass [g]"] == pytest.approx(lattice, rel=1e-12)
    assert run.summary["mass_error [%]"] == pytest.approx(100.0 * (lattice / ROD - 1.0), rel=1e-9)
    assert len(run.summary["warnings"]) == 1


def test_a_mass_far_off_is_refused_before_anything_is_written(tmp_path: Path):
    # 2.5 mm: 4 points of 15.6 mm^3 in each of 10 layers, 0.625 g
    case = vp.Case.load("paper", LATTICE | {"method.spacing": "2.5 mm"})
    with pytest.raises(vp.InputError) as refused:
        vp.run(case, tmp_path / "run")
    told = "method.spacing: the computed mass, 0.625 g, is -46 % off that of the rod, 1.152 g (guards.mass_error allows"
    assert str(refused.value).startswith(told)
    assert 'take method.fill = "trimmed"' in str(refused.value)
    assert list(tmp_path.iterdir()) == []


def test_a_case_may_allow_a_mass_that_is_far_off():
    case = vp.Case.load("paper", LATTICE | {"method.spacing": "2.5 mm", "guards.mass_error": 0.5})
    with pytest.warns(vp.ResultWarning, match="-46 % off"):
        run = vp.run(case, figures=False)
    assert run.status == "complete"


def test_the_wall_force_of_a_slender_bar_is_that_of_its_whole_section():
    # 1 m/s, uniaxial stress: rho c v A with c of E = 9KG/(3K+G), while the reflection is on its way (2 L/c = 165 us);
    # front and Pochhammer's dispersion die away as (radius/length)^2, and the mesh adds as much
    faults = {
        "title": "", "rod": {"radius": "0.5 mm", "length": "20 mm"}, "impact": {"speed": "1 m/s"},
        "material": {"law": "elastic", "density": "1 g/cm^3", "bulk": "1 GPa", "shear": "0.6 GPa"},
        "method": {"name": "fem", "size": "0.5 mm"}, "time": {"end": "30 us"},
    }  # fmt: skip
    run = vp.run(vp.Case.from_tables(faults), figures=False)
    young = 9.0 * 1000.0 * 600.0 / (3.0 * 1000.0 + 600.0)
    expected = math.sqrt(young / 1e-3) * 1e-3 * math.pi * 0.5**2  # N
    impulse = np.interp([10e-3, 25e-3], run.columns["time"], run.columns["wall_impulse"])
    assert np.diff(impulse)[0] / 15e-3 == pytest.approx(expected, rel=0.005)
