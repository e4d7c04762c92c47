import base64
import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from scenes import runs_side_by_side, scene_of_runs  # noqa: F401

import viscopoint as vp
from viscopoint.methods.fem.mesh import point_volumes
from viscopoint.model.method import Field
from viscopoint.report.packing import Packed
from viscopoint.report.scene import QUANTITIES, Scene, scene_of
from viscopoint.report.surfaces import at_points, skin_of_elements, skin_of_points
from viscopoint.results.reader import Snapshot

FAST = {
    "method.size": "1.5 mm", "method.safety": 0.5, "method.delete_below": 0.1, "impact.speed": "1000 m/s",
    "time.end": "16 us", "time.snapshots": ["4 us"], "guards.lost_share": 1.0, "guards.hourglass_share": 1.0,
}  # fmt: skip


@pytest.fixture(scope="module")
def eroded() -> vp.Run:
    """A run so fast that elements are deleted."""
    with pytest.warns(vp.ResultWarning):
        return vp.run(vp.Case.load("paper", FAST, method="fem"), figures=False)


# --- surfaces ---


def enclosed(position: NDArray[np.float64], faces: NDArray[np.int64]) -> float:
    """Return the volume within quadrilaterals, split as the viewer does: ∮ x·n/3 over triangles."""
    triangles = position[np.concatenate([faces[:, [0, 1, 2]], faces[:, [0, 2, 3]]])]
    return float(np.einsum("ti,ti->", triangles[:, 0], np.cross(triangles[:, 1], triangles[:, 2])) / 6.0)


def area(position: NDArray[np.float64], faces: NDArray[np.int64]) -> float:
    x = position[faces]
    return float(np.linalg.norm(np.cross(x[:, 2] - x[:, 0], x[:, 3] - x[:, 1]), axis=1).sum() / 2.0)


def indices(text: str) -> NDArray[np.int64]:
    return np.frombuffer(base64.b64decode(text), "<u4").astype(np.int64)


def test_surface_of_elements_encloses_the_body(finished_fem: Path):
    run = vp.Run(finished_fem)
    skin = skin_of_elements(run.body, [run.snapshot(0)])
    assert len(skin.points) < len(run.body.position)
    assert enclosed(run.body.position[skin.points], skin.faces[0]) == pytest.approx(run.body.volume.sum(), rel=1e-12)


def test_scene_encloses_the_body_but_for_packing(scene: Scene, finished_fem: Path):
    shape = scene.shapes[0]
    table = json.loads(scene.to_json())["shapes"][0]
    position = np.column_stack([Packed(**packed).values() for packed in table["arrays"][0][:3]])
    faces = indices(table["faces"][table["facesAt"][0]]).reshape(-1, 4)
    half = np.linalg.norm([packed.step / 2 for packed in shape.arrays[0][:3]])
    volume = vp.Run(finished_fem).body.volume.sum()
    assert abs(enclosed(position, faces) - volume) <= 1.01 * half * area(position, faces)  # each corner moves by half


def test_what_deleted_elements_covered_comes_to_light(eroded: vp.Run):
    snapshots = [eroded.snapshot(number) for number in range(len(eroded.times))]
    alive = [snapshot["deleted"] == 0 for snapshot in snapshots]
    assert 0 < np.count_nonzero(alive[-1]) < len(alive[-1])
    skin = skin_of_elements(eroded.body, snapshots)
    assert skin.faces_at[0] == 0
    assert skin.faces_at[-1] > 0
    start = eroded.body.position
    for number, lives in enumerate(alive):  # measured where the rod started: planes there, so triangles are exact
        volume = point_volumes(start, eroded.body.cells[lives]).sum()
        assert enclosed(start[skin.points], skin.faces[skin.faces_at[number]]) == pytest.approx(volume, rel=1e-12)


def test_nodes_of_deleted_elements_are_hidden(finished_fem: Path, monkeypatch: pytest.MonkeyPatch):
    run = vp.Run(finished_fem)
    read: Callable[[int], Snapshot] = run.snapshot
    height = run.body.position[:, 2]
    gone = height > height.max() - 1e-9  # with all elements of the uppermost layer

    def without_tail(number: int) -> Snapshot:
        snapshot = read(number)
        if number > 0:
            snapshot["deleted"][gone[run.body.cells].any(axis=1)] = 1
            snapshot["lost"][gone] = 1
        return snapshot

    monkeypatch.setattr(run, "snapshot", without_tail)
    shape = scene_of({("soft", "FEM"): run}).shapes[0]
    hidden = np.isnan([[packed.values() for packed in arrays] for arrays in shape.arrays])
    assert not hidden[0].any()
    assert (hidden[1:] == gone[shape.skin.points]).all()
    assert not gone[shape.skin.points][shape.skin.faces[shape.skin.faces_at[1]]].any()


def test_field_on_elements_is_the_mean_of_those_that_live_around_a_node(finished_fem: Path):
    run = vp.Run(finished_fem)
    count = len(run.body.cells)
    alive = np.ones(count, bool)
    alive[0] = False
    snapshot = Snapshot(0.0, {"deleted": Field((~alive).astype(np.uint8), "1", "cells")})
    values = np.linspace(1.0, 2.0, count)
    found = at_points(Field(values, "MPa", "cells"), snapshot, run.body)
    for node in (int(run.body.cells[0][0]), int(run.body.cells[-1][-1])):
        around = alive & (run.body.cells == node).any(axis=1)
        expected = values[around].mean() if around.any() else np.nan
        assert found[node] == pytest.approx(expected, rel=1e-12, nan_ok=True)


def test_surface_of_points_is_what_the_figures_show(finished: Path):
    body = vp.Run(finished).body
    skin = skin_of_points(body)
    radius, height = np.hypot(*body.position[:, :2].T), body.position[:, 2]
    hidden = np.setdiff1d(np.arange(len(body.position)), skin.points)
    assert radius[hidden].max() <= 3.8 - skin.edge
    assert height[hidden].min() > height.min()
    assert height[hidden].max() < height.max()
    assert skin.edge == pytest.approx(0.72)


def test_fewer_points_make_larger_cubes_in_the_same_places(finished: Path):
    body = vp.Run(finished).body
    fine, coarse = skin_of_points(body), skin_of_points(body, 2)
    assert coarse.edge == pytest.approx(2 * fine.edge)
    assert set(coarse.points) < set(fine.points)
    assert len(fine.points) / 8 <= len(coarse.points) <= len(fine.points) / 2
    blocks = np.floor(body.position[fine.points] / coarse.edge + 1e-6)
    assert len(np.unique(blocks, axis=0)) == len(coarse.points)


# --- the scene ---


def test_scene_holds_the_fields_at_all_snapshots(scene: Scene, runs: dict[tuple[str, str], vp.Run]):
    assert scene.times == pytest.approx([0.0, 1.0, 2.0])
    assert (scene.materials, scene.methods) == (("soft",), ("FEM", "MPM"))
    run, shape = runs["soft", "MPM"], scene.shapes[1]
    for number in range(len(run.times)):
        snapshot = run.snapshot(number)
        exact = [
            *snapshot["position"].T, snapshot["velocity"][:, 2], snapshot["displacement"][:, 0], snapshot["pressure"],
            snapshot["von_mises"],
        ]  # fmt: skip
        for values, packed in zip(exact, shape.arrays[number], strict=True):
            error = np.abs(packed.values() - values[shape.skin.points])
            assert error.max() <= packed.step / 2 * (1 + 1e-9) + 1e-12 * np.abs(values).max()


def test_units_are_those_of_the_run(runs: dict[tuple[str, str], vp.Run]):
    for run in runs.values():
        for quantity in QUANTITIES:
            assert run.snapshot(-1).fields[quantity.field].unit == quantity.unit


def test_colours_span_one_range_for_all_runs(scene: Scene):
    for number, (low, high) in enumerate(scene.ranges):
        for shape in scene.shapes:
            for arrays in shape.arrays:
                values, step = arrays[3 + number].values(), arrays[3 + number].step
                outside = np.count_nonzero((values < low - step) | (values > high + step))
                assert outside <= 0.02 * len(values) + 2  # a per cent at either end, and rounding
    velocity, displacement, _, von_mises = scene.ranges
    assert velocity[0] <= -150.0
    assert displacement[0] == -displacement[1]
    assert von_mises[0] == 0.0
    assert all(low < high for low, high in scene.ranges)


def test_all_that_is_shown_is_in_the_box_and_so_is_the_wall(scene: Scene):
    for shape in scene.shapes:
        for arrays in shape.arrays:
            for (low, high), packed in zip(scene.box, arrays[:3], strict=True):
                assert packed.values().min() - shape.skin.edge / 2 >= low
                assert packed.values().max() + shape.skin.edge / 2 <= high
        assert scene.box[2][0] <= shape.wall == -0.01
    widths = [high - low for low, high in scene.box[:2]]
    assert widths[0] == pytest.approx(widths[1])


def test_lost_points_and_those_that_flew_away_are_hidden(finished: Path, monkeypatch: pytest.MonkeyPatch):
    run = vp.Run(finished)
    read: Callable[[int], Snapshot] = run.snapshot
    lost, far, broken = skin_of_points(run.body).points[[0, 10, 20]]

    def spoilt(number: int) -> Snapshot:
        snapshot = read(number)
        snapshot["lost"][lost] = 1
        snapshot["position"][far] = 1e6
        snapshot["pressure"][broken] = np.inf
        return snapshot

    monkeypatch.setattr(run, "snapshot", spoilt)
    scene = scene_of({("soft", "MPM"): run})
    for arrays in scene.shapes[0].arrays:
        for packed in arrays:
            assert np.flatnonzero(np.isnan(packed.values())).tolist() == [0, 10, 20]
    assert max(high for _, high in scene.box) < 30.0


def test_run_that_ended_early_shows_its_last_snapshot(finished: Path, tmp_path: Path):
    run = vp.Run(finished)
    short = vp.run(run.case.with_({"time.end": "1 us", "time.snapshots": []}), tmp_path / "short", figures=False)
    scene = scene_of({("soft", "MPM"): run, ("stopped", "MPM"): short})
    assert scene.times == pytest.approx([0.0, 1.0, 2.0])
    assert [shape["shown"] for shape in json.loads(scene.to_json())["shapes"]] == [[0, 1, 2], [0, 1, 1]]


def test_large_runs_are_shown_coarser_or_refused(runs: dict[tuple[str, str], vp.Run], scene: Scene):
    points = {("soft", "MPM"): runs["soft", "MPM"]}
    size = len(scene_of(points).to_json())
    coarser = scene_of(points, limit=size // 2)
    assert len(coarser.to_json()) < 0.6 * size
    assert coarser.shapes[0].skin.edge > scene.shapes[1].skin.edge
    with pytest.raises(vp.InputError, match=r"3 snapshots would take .* MB .*fewer \(time.snapshots\).*method.spacing"):
        scene_of(points, limit=1000)
    with pytest.raises(vp.InputError, match=r"larger method.size"):
        scene_of({("soft", "FEM"): runs["soft", "FEM"]}, limit=1000)
    with pytest.raises(vp.InputError, match="no run to show"):
        scene_of({})
