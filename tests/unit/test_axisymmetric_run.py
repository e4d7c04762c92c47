"""Axisymmetric runs by finite elements: mesh, case, outputs, pictures, comparisons."""

import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import pyvista
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

import viscopoint as vp
from viscopoint.comparison.axis import axial_velocity
from viscopoint.figures import faces, halves, shapes
from viscopoint.figures.revolve import surface_points, turned
from viscopoint.methods.fem.forms import quality
from viscopoint.methods.fem.section import point_volumes, section_elements, section_mesh
from viscopoint.model.body import Body, Surface, spacing
from viscopoint.model.measurements import measure
from viscopoint.model.method import Field
from viscopoint.report.scene import scene_of
from viscopoint.results.output.fields import file_of
from viscopoint.results.reader import Snapshot

RINGS = {"method.geometry": "axisymmetric", "method.size": "0.76 mm", "time.end": "2 us", "time.snapshots": ["1 us"]}
RADIUS, LENGTH = 3.8, 25.4  # mm, of the paper's rod


@pytest.fixture(scope="module")
def done(tmp_path_factory: pytest.TempPathFactory) -> vp.Run:
    return vp.run(vp.Case.load("paper", RINGS, method="fem"), tmp_path_factory.mktemp("runs") / "rings")


# --- the mesh ---


@pytest.mark.parametrize(
    ("size", "grading"), [(3.8, 0.5), (3.8, 1.0), (1.0, 0.5), (1.0, 3.0), (0.19, 1.0), (0.19, 3.0)]
)
def test_half_section_fills_the_rod_exactly(size: float, grading: float):
    body = section_mesh(RADIUS, LENGTH, size, grading)
    assert body.volume.sum() == pytest.approx(np.pi * RADIUS**2 * LENGTH, rel=1e-12)
    assert len(body.cells) == section_elements(RADIUS, LENGTH, size, grading)
    assert (body.position[:, 0].min(), np.ptp(body.position[:, 1])) == (0.0, 0.0)
    assert quality(body.position, body.cells).least_jacobian == pytest.approx(1.0)
    shape = measure(body.surface, body.position)
    assert (shape.length, shape.impact_face_radius, shape.greatest_radius) == pytest.approx((LENGTH, RADIUS, RADIUS))
    # first layers are no thicker than asked, columns neither
    assert body.position[1, 0] <= size * (1 + 1e-9)
    assert body.position[body.surface.ring[1, 0], 2] <= size * (1 + 1e-9)


# --- the case ---


def test_geometry_is_kept_when_the_case_is_written_and_read_back(done: vp.Run):
    kept = tomllib.loads((done.folder / "case.toml").read_text())["method"]
    assert (kept["name"], kept["geometry"], kept["element"]) == ("fem", "axisymmetric", "one-point")
    again = vp.Case.load(done.folder / "case.toml", method="fem")
    assert again.method == done.case.method


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"method.geometry": "2d"}, r"method\.geometry: .*axisymmetric"),
        ({"method.size": "4 mm"}, "larger than the rod"),
        ({"method.element": "triangle"}, "allowed: one-point, selective"),
    ],
)
def test_bad_cases_are_refused(changes: dict[str, Any], message: str):
    with pytest.raises(vp.CaseError, match=message):
        vp.Case.load("paper", RINGS | changes, method="fem")


def test_a_mesh_of_hexahedra_is_refused_for_an_axisymmetric_body(tmp_path: Path):
    (tmp_path / "rod.vtu").touch()
    table = {"name": "fem", "geometry": "axisymmetric", "mesh": str(tmp_path / "rod.vtu")}
    with pytest.raises(vp.CaseError, match=r'method\.geometry: "axisymmetric" cannot be given with method\.mesh'):
        vp.Case.load("paper", {"method": table})


# --- what a run leaves ---


def test_fields_open_in_vtk_as_quadrilaterals_of_the_half_section(done: vp.Run):
    mesh: Any = pyvista.read(file_of(done.folder, 0))
    assert np.array_equal(mesh.cells_dict[pyvista.CellType.QUAD], done.body.cells)
    assert mesh.compute_cell_sizes()["Area"].sum() == pytest.approx(RADIUS * LENGTH, rel=1e-12)
    last = done.snapshot(-1)
    assert last["stress"].shape == (len(done.body.cells), 6)
    assert np.array_equal(last["velocity"][:, 1], np.zeros(len(done.body.position)))
    now = point_volumes(last["position"], done.body.cells).sum(axis=1)
    start = point_volumes(done.body.position, done.body.cells).sum(axis=1)
    assert now == pytest.approx(last["jacobian"] * start, rel=1e-12)
    assert 0.5 < last["scaled_jacobian"].min() < 1.0


def test_momentum_is_along_the_axis_and_exact(done: vp.Run):
    assert done.results.momentum_error < 1e-12
    assert done.rows[0].momentum == pytest.approx(-1e-3 * np.pi * RADIUS**2 * LENGTH * 150.0, rel=1e-12)


def test_an_axisymmetric_run_is_compared_with_a_whole_one(done: vp.Run, finished_fem: Path):
    assert vp.compare([finished_fem, done], times=[0.001, 0.002]).physics == ()
    state = vp.compare([finished_fem, done]).states[-1][1]
    # sizes of 1.2 and 0.76 mm: both are wrong by less than a tenth of an element
    assert state.apart.distance < 0.1
    height, speed = axial_velocity(done, done.snapshot(-1))
    assert len(height) == len(done.body.surface.ring)
    assert speed[-1] == pytest.approx(-150.0)
    assert speed[0] == pytest.approx(0.0, abs=1e-9)


# --- how it looks ---


def shown_area(run: vp.Run, snapshot: Snapshot, shown: Any, tilt: float) -> float:
    """Return the area of all faces that are drawn [mm^2]."""
    axis = Figure().subplots()
    faces.paint(axis, run, snapshot, shown, shapes.seen(snapshot["position"], tilt), Normalize())
    corner = np.array([np.asarray(path.vertices)[:4] for path in axis.collections[0].get_paths()])
    (x, y), (u, v) = (corner[:, 2] - corner[:, 0]).T, (corner[:, 3] - corner[:, 1]).T
    return float(abs(x * v - y * u).sum()) / 2


def test_the_turned_section_is_drawn_as_the_silhouette_of_the_rod(done: vp.Run):
    start = done.snapshot(0)
    section, end = 2 * RADIUS * LENGTH, np.pi * RADIUS**2 * np.sin(2 * np.pi / 48) / (2 * np.pi / 48)
    assert shown_area(done, *halves.outside(done, start), 0.0) == pytest.approx(section)
    assert shown_area(done, *halves.cut_open(done, start), 0.0) == pytest.approx(section)
    tilted = section * np.cos(0.3) + end * np.sin(0.3)
    assert shown_area(done, *halves.outside(done, start), 0.3) == pytest.approx(tilted)
    assert {file.stem for file in (done.folder / "figures").iterdir()} == {
        "shapes", "profiles", "histories", "energies",
    }  # fmt: skip


def test_deleted_rings_are_not_drawn(done: vp.Run):
    snapshot = done.snapshot(0)
    snapshot["deleted"][:] = done.body.position[done.body.cells].mean(axis=1)[:, 2] > 0.5 * LENGTH
    place, shown = halves.cut_open(done, snapshot)
    assert place["position"][shown, 2].max() <= 0.5 * LENGTH + 0.76
    snapshot["deleted"][:] = 1
    assert len(halves.outside(done, snapshot)[1]) == len(halves.cut_open(done, snapshot)[1]) == 0


def test_the_view_in_three_dimensions_encloses_the_rod(done: vp.Run):
    shape = scene_of({("soft", "FEM"): done}).shapes[0]
    x = np.column_stack([packed.values() for packed in shape.arrays[0][:3]])[shape.skin.faces[0]]
    triangles = np.concatenate([x[:, [0, 1, 2]], x[:, [0, 2, 3]]])
    volume = np.einsum("ti,ti->", triangles[:, 0], np.cross(triangles[:, 1], triangles[:, 2])) / 6.0
    polygon = np.sin(2 * np.pi / 48) / (2 * np.pi / 48)
    assert volume == pytest.approx(polygon * np.pi * RADIUS**2 * LENGTH, rel=1e-4)  # packed in 16 bits


def test_material_points_of_a_half_plane_are_turned_at_their_spacing():
    """As the pictures of other methods have them: points of squares of 0.5 mm, their volumes those of rings."""
    h, columns, layers = 0.5, 4, 6
    x = np.tile(np.linspace(0.5, columns - 0.5, columns) * h, layers)
    z = np.repeat(np.linspace(0.5, layers - 0.5, layers) * h, columns)
    index = np.arange(len(x)).reshape(layers, columns)
    ends = [np.column_stack([index[a], index[b]]) for a, b in ((-1, -2), (0, 1))]
    surface = Surface(index[:, -1:], np.array([1.75]), 2.0, ends[0], ends[1], 0.5, 0.0)
    body = Body(np.column_stack([x, 0 * x, z]), 2 * np.pi * x * h**2, surface)
    assert spacing(body) == pytest.approx(h)
    found = surface_points(body)
    at_rim = found.points == index[2, -1]
    assert np.count_nonzero(at_rim) == round(2 * np.pi * 1.75 / h)
    place = turned(body.position[found.points], found.angle)
    assert np.hypot(*place[at_rim, :2].T) == pytest.approx(1.75)
    assert not np.isin(found.points, index[1:-1, :-1]).any()
    run: Any = type("Run", (), {"body": body})()
    fields = {"position": body.position, "velocity": body.position, "lost": np.zeros(len(x))}
    snapshot = Snapshot(0.0, {name: Field(values, "1") for name, values in fields.items()})
    whole, shown = halves.cut_open(run, snapshot)
    assert sorted(whole["position"][shown, 0]) == pytest.approx(sorted([*x, *-x]))
