import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import pyvista
from typer.testing import CliRunner
from vtkmodules.vtkIOExodus import vtkExodusIIWriter

import viscopoint as vp
from viscopoint.command_line.cli import app
from viscopoint.methods.fem.reading import read_rod
from viscopoint.methods.fem.rod import rod_mesh

RADIUS, LENGTH, SIZE = 3.8, 25.4, 1.9  # mm; of the paper's rod, and of few elements
SHORT = {"time.end": "2 us", "time.snapshots": ["1 us"]}
ROD = rod_mesh(RADIUS, LENGTH, SIZE)
BOX = pyvista.ImageData(dimensions=(3, 3, 9), origin=(-1.0, -1.0, 0.0))  # 2 x 2 x 8 mm
GARBAGE = bytes(range(256)) * 4


def grid_of(position: Any, cells: Any) -> pyvista.UnstructuredGrid:
    return pyvista.UnstructuredGrid({pyvista.CellType.HEXAHEDRON: cells}, position)


def saved(grid: Any, path: Path) -> Path:
    grid.save(path)
    return path


def case_of(mesh: Path, unit: str = "1 mm") -> vp.Case:
    return vp.Case.load("paper", SHORT | {"method": {"name": "fem", "mesh": str(mesh), "mesh_unit": unit}})


@pytest.fixture(scope="module")
def built_in() -> vp.Run:
    return vp.run(vp.Case.load("paper", SHORT | {"method": {"name": "fem", "size": f"{SIZE} mm"}}), figures=False)


def assert_same_run(run: vp.Run, other: vp.Run, rounding: float) -> None:
    for number in range(len(other.times)):
        ours, theirs = run.snapshot(number), other.snapshot(number)
        for name in theirs.fields:
            assert np.allclose(ours[name], theirs[name], rtol=rounding, atol=rounding * abs(theirs[name]).max()), name
    for ours, theirs in zip(run.rows, other.rows, strict=True):
        # sums over nodes in another order
        assert ours[3:9] == pytest.approx(theirs[3:9], rel=max(rounding, 1e-14))
    height, radius = run.profile(run.snapshot(-1))
    heights, radii = other.profile(other.snapshot(-1))
    assert height == pytest.approx(heights, rel=max(rounding, 1e-14), abs=1e-12)
    assert radius == pytest.approx(radii, rel=max(rounding, 1e-14))


@pytest.mark.parametrize("name", ["rod.vtu", "rod.vtk", "rod.vtkhdf", "ROD.VTU"])
def test_a_mesh_file_gives_the_run_of_the_built_in_mesh_bit_for_bit(built_in: vp.Run, tmp_path: Path, name: str):
    saved(grid_of(ROD.position, ROD.cells), tmp_path / name.lower()).rename(tmp_path / name)
    assert_same_run(vp.run(case_of(tmp_path / name), figures=False), built_in, rounding=0.0)


def test_a_mesh_in_metres_gives_the_same_run_but_for_rounding(built_in: vp.Run, tmp_path: Path):
    mesh = saved(grid_of(ROD.position / 1e3, ROD.cells), tmp_path / "rod.vtu")
    assert_same_run(vp.run(case_of(mesh, "1 m"), figures=False), built_in, rounding=1e-9)


def test_the_order_of_elements_is_free(built_in: vp.Run, tmp_path: Path):
    shuffled = np.random.default_rng(0).permutation(ROD.cells)
    run = vp.run(case_of(saved(grid_of(ROD.position, shuffled), tmp_path / "rod.vtu")), figures=False)
    assert np.allclose(run.snapshot(-1)["position"], built_in.snapshot(-1)["position"], rtol=0.0, atol=1e-11)
    assert run.rows[-1].length == pytest.approx(built_in.rows[-1].length, rel=1e-12)


@pytest.mark.parametrize(
    ("name", "grid"),
    [
        ("voxels.vtu", BOX.cast_to_unstructured_grid()),
        ("image.vtk", BOX),
        ("structured.vtk", BOX.cast_to_structured_grid()),
    ],
)
def test_voxels_images_and_structured_grids_are_hexahedra(tmp_path: Path, name: str, grid: Any):
    body = read_rod(saved(grid, tmp_path / name), 1.0, np.sqrt(2.0), 8.0)
    assert len(body.cells) == 32
    assert body.volume.sum() == pytest.approx(2.0 * 2.0 * 8.0)
    assert body.surface.ring.shape == (9, 4)  # the corners of the section stand furthest out


def test_blocks_of_an_exodus_file_share_the_nodes_between_them(tmp_path: Path):
    grid = grid_of(ROD.position, ROD.cells)
    upper = grid.cell_centers().points[:, 2] > LENGTH / 2
    writer: Any = vtkExodusIIWriter()
    writer.SetFileName(str(tmp_path / "rod.exo"))
    writer.SetInputData(pyvista.MultiBlock([grid.extract_cells(upper), grid.extract_cells(~upper)]))
    writer.Write()
    body = read_rod(tmp_path / "rod.exo", 1.0, RADIUS, LENGTH)
    assert (len(body.position), len(body.cells)) == (len(ROD.position), len(ROD.cells))
    assert body.volume.sum() == pytest.approx(ROD.volume.sum())


def with_surface(position: Any) -> pyvista.UnstructuredGrid:
    """Return the rod with quadrilaterals on its foot and a line of its first and last node, as meshers leave them."""
    foot = ROD.cells[: len(ROD.cells) // 2, :4]
    line = np.array([[0, len(position) - 1]])
    cells = {pyvista.CellType.HEXAHEDRON: ROD.cells, pyvista.CellType.QUAD: foot, pyvista.CellType.LINE: line}
    return pyvista.UnstructuredGrid(cells, position)


def test_surface_cells_and_lines_beside_the_hexahedra_are_ignored(tmp_path: Path):
    body = read_rod(saved(with_surface(ROD.position), tmp_path / "rod.vtu"), 1.0, RADIUS, LENGTH)
    assert np.array_equal(body.cells, ROD.cells)
    assert np.array_equal(body.volume, ROD.volume)


def as_gmsh_writes(position: Any, cells: Any, extra: Any) -> str:
    """Return a legacy VTK file like Gmsh's: points of the geometry come first, each a vertex, and there is a line."""
    points, first = np.vstack([extra, position]), len(extra)
    entries = [[1, number] for number in range(first)] + [[2, 0, first]] + [[8, *(corner + first)] for corner in cells]
    kinds = [1] * first + [3] + [12] * len(cells)
    lines = ["# vtk DataFile Version 2.0", "rod, Created by Gmsh", "ASCII", "DATASET UNSTRUCTURED_GRID"]
    lines += [f"POINTS {len(points)} double", *(" ".join(map(repr, map(float, point))) for point in points), ""]
    lines += [f"CELLS {len(entries)} {sum(map(len, entries))}", *(" ".join(map(str, entry)) for entry in entries), ""]
    return "\n".join([*lines, f"CELL_TYPES {len(kinds)}", *map(str, kinds), ""])


def test_nodes_that_no_hexahedron_has_are_left_out_with_a_warning(tmp_path: Path):
    # Gmsh keeps the centres of arcs, here beyond the rod and one that is no number
    extra = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 99.0], [np.nan, 0.0, 0.0]])
    file = tmp_path / "rod.vtk"
    file.write_text(as_gmsh_writes(ROD.position, ROD.cells, extra))
    with pytest.warns(vp.ViscopointWarning, match=r"rod\.vtk: 3 of 258 nodes belong to no hexahedron and are left out"):
        body = read_rod(file, 1.0, RADIUS, LENGTH)
    assert np.array_equal(body.position, ROD.position)
    assert np.array_equal(body.cells, ROD.cells)
    assert np.array_equal(
        body.surface.ring,
        read_rod(saved(grid_of(ROD.position, ROD.cells), tmp_path / "rod.vtu"), 1.0, RADIUS, LENGTH).surface.ring,
    )


@pytest.mark.filterwarnings("default::viscopoint.ViscopointWarning")
def test_a_warning_of_unused_nodes_is_one_line_of_the_command(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.chdir(tmp_path)
    Path("rod.vtk").write_text(as_gmsh_writes(ROD.position, ROD.cells, np.zeros((1, 3))))
    settings = ["method={name='fem', mesh='rod.vtk'}", "time.end=0.1 us", "time.snapshots=[]"]
    words = [word for setting in settings for word in ("--set", setting)]
    result = CliRunner().invoke(app, ["run", "paper", *words, "--out", "run"])
    assert result.exit_code == 0
    told = "viscopoint: method.mesh: rod.vtk: 1 of 256 nodes belong to no hexahedron and are left out\n"
    assert result.stderr == told
    with pytest.warns(vp.ViscopointWarning, match="left out"):
        assert len(vp.Run("run").body.position) == len(ROD.position) == len(vp.Run("run").snapshot(0)["position"])


@pytest.mark.parametrize("suffix", ["e", "exo", "ex2", "exii", "g", "gen", "G"])
def test_exodus_files_go_by_all_their_names(tmp_path: Path, suffix: str):
    writer: Any = vtkExodusIIWriter()
    writer.SetFileName(str(tmp_path / "rod.exo"))
    writer.SetInputData(pyvista.MultiBlock([grid_of(ROD.position, ROD.cells)]))
    writer.Write()
    body = read_rod((tmp_path / "rod.exo").rename(tmp_path / f"mesh.{suffix}"), 1.0, RADIUS, LENGTH)
    assert (len(body.position), len(body.cells)) == (len(ROD.position), len(ROD.cells))
    assert body.volume.sum() == pytest.approx(ROD.volume.sum())


def test_the_mesh_is_looked_for_in_the_folder_of_the_case_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    (tmp_path / "cases").mkdir()
    saved(grid_of(ROD.position, ROD.cells), tmp_path / "cases" / "rod.vtu")
    file = tmp_path / "cases" / "mine.toml"
    file.write_text('extends = "paper"\n[method]\nname = "fem"\nmesh = "rod.vtu"\n')
    for place in (tmp_path, tmp_path / "cases"):
        monkeypatch.chdir(place)
        case = vp.Case.load(file.relative_to(place))
        assert len(case.method.body(case.rod).cells) == len(ROD.cells)


def test_a_run_folder_keeps_the_mesh_and_opens_when_the_original_is_gone_and_it_was_moved(tmp_path: Path):
    mesh = saved(grid_of(ROD.position, ROD.cells), tmp_path / "rod.vtu")
    vp.run(case_of(mesh), tmp_path / "run", figures=False)
    mesh.unlink()
    run = vp.Run((tmp_path / "run").rename(tmp_path / "moved"))
    assert np.array_equal(run.body.position, run.snapshot(0)["position"])
    assert run.profile(run.snapshot(0))[1] == pytest.approx(RADIUS)
    assert len(run.draw()) == 4
    again = vp.run(vp.Case.load(run.folder / "case.toml"), tmp_path / "again", figures=False)
    assert_same_run(again, run, rounding=0.0)
    assert tomllib.loads((tmp_path / "again" / "case.toml").read_text())["method"]["mesh"] == "mesh.vtu"


def test_force_does_not_remove_the_mesh_that_the_case_needs(tmp_path: Path):
    vp.run(case_of(saved(grid_of(ROD.position, ROD.cells), tmp_path / "rod.vtu")), tmp_path / "run", figures=False)
    with pytest.raises(vp.InputError, match=r"holds .*mesh\.vtu, which is needed; choose another place"):
        vp.run(vp.Case.load(tmp_path / "run" / "case.toml"), tmp_path / "run", force=True)
    assert vp.Run(tmp_path / "run").body.cells.shape == ROD.cells.shape


def test_a_mesh_has_no_resolution_to_give_another_method(tmp_path: Path):
    file = tmp_path / "mine.toml"
    file.write_text('extends = "paper"\n[method]\nname = "fem"\nmesh = "rod.vtu"\n')
    (tmp_path / "rod.vtu").touch()
    assert vp.Case.load(file, method="fem") == vp.Case.load(file)
    with pytest.raises(vp.InputError, match=r"write a \[method\] table"):
        vp.Case.load(file, method="mpm")


def test_rounded_coordinates_still_stand_on_the_wall(tmp_path: Path):
    # as of a file in single precision: a part of the foot would be held, or begin below the wall
    shaken = ROD.position + np.random.default_rng(5).uniform(-1e-6, 1e-6, ROD.position.shape)
    body = read_rod(saved(grid_of(shaken, ROD.cells), tmp_path / "rod.vtu"), 1.0, RADIUS, LENGTH)
    assert (body.position[ROD.position[:, 2] == 0.0, 2] == 0.0).all()


# --- what is refused ---


def bent(change: str) -> pyvista.UnstructuredGrid:
    """Return the rod's mesh with one thing wrong."""
    position, cells = ROD.position.copy(), ROD.cells.copy()
    if change == "inverted element":
        cells[7, [0, 1]] = cells[7, [1, 0]]
    elif change == "repeated corner":
        cells[7, 1] = cells[7, 0]
    elif change == "coincident nodes":
        position[cells[7, 1]] = position[cells[7, 0]]
    elif change == "not a number":
        position[5, 1] = np.nan
    elif change == "two pieces":
        upper = position[cells].mean(axis=1)[:, 2] > LENGTH / 2
        cells[upper] += len(position)
        there, corner = np.unique(cells, return_inverse=True)
        position, cells = np.vstack([position, position])[there], corner.reshape(-1, 8)
    elif change == "six rods":
        position = np.vstack([position + [20.0 * number, 0.0, 0.0] for number in range(6)])
        cells = np.vstack([cells + number * len(ROD.position) for number in range(6)])
    elif change == "off the wall":
        position[:, 2] += 1.0
    elif change == "a little off the wall":
        position[:, 2] += 0.02
    elif change == "elements twice":
        cells = np.vstack([cells, cells[3:6]])
    elif change == "a cone":
        position[:, :2] *= 1.0 - 0.5 * position[:, 2:] / LENGTH
    elif change == "a gap":
        middle = position[cells].mean(axis=1)
        cells = cells[(middle[:, 0] < 0.0) | (middle[:, 1] < 0.0)]
        there, corner = np.unique(cells, return_inverse=True)
        position, cells = position[there], corner.reshape(-1, 8)
    elif change == "off the axis":
        position[:, 0] += 1.0
    return grid_of(position, cells)


def cell_of(kind: str) -> pyvista.UnstructuredGrid:
    return getattr(pyvista.examples.cells, kind)()


@pytest.mark.parametrize(
    ("grid", "message"),
    [
        (bent("inverted element"), r"1 of 168 elements are inverted or degenerate; the worst is element 7 at \("),
        (bent("repeated corner"), r"1 of 168 elements are .* element 7 .* scaled Jacobian of 0"),
        (bent("coincident nodes"), r"elements are inverted or degenerate"),
        (bent("not a number"), r"coordinates are not all finite"),
        (
            bent("two pieces"),
            r"2 separate pieces that share no node, x -4\.005 to 4\.005, y -4\.005 to 4\.005, z 0 to 12\.7 mm; "
            r"x -4\.005 to 4\.005, y -4\.005 to 4\.005, z 12\.7 to 25\.4 mm\. One body is supported: leave the rod "
            "alone",
        ),
        (bent("six rods"), r"6 separate pieces .*; x 36 to 44, .*; and 2 more\. One body is supported"),
        (bent("off the wall"), r"reaches from z = 1 mm to 26.4 mm"),
        (bent("a little off the wall"), r"reaches from z = 0.02 mm"),
        (bent("elements twice"), r"3 elements stand in the place of others"),
        (bent("a cone"), r"but a rod of this length and radius has 1152"),
        (bent("a gap"), r"but a rod of this length and radius has 1152"),
        (bent("off the axis"), r"5.00485 mm from the z axis"),
        (pyvista.UnstructuredGrid(), r"holds no hexahedra"),
        (cell_of("Quadrilateral"), r"holds no hexahedra"),
        (cell_of("Tetrahedron"), r"type tetra; only hexahedra of eight nodes"),
        (cell_of("Wedge"), r"type wedge; only"),
        (cell_of("Polyhedron"), r"type polyhedron; only"),
        (cell_of("QuadraticHexahedron"), r"type quadratic hexahedron; only"),
    ],
)
def test_a_mesh_that_is_not_a_sound_rod_of_hexahedra_is_refused(tmp_path: Path, grid: Any, message: str):
    path = saved(grid, tmp_path / "rod.vtu")
    with pytest.raises(vp.InputError, match=rf"method.mesh: .*rod\.vtu: .*{message}"):
        read_rod(path, 1.0, RADIUS, LENGTH)


ANOTHER = r"rod\.length .* and rod\.radius .*; is method\.mesh_unit right"


@pytest.mark.parametrize(
    ("unit", "radius", "length", "message"),
    [
        (1e3, 3.8, 25.4, ANOTHER), (1.0, 4.1, 25.4, ANOTHER), (1.0, 3.8, 25.0, ANOTHER),
        (1.0, 3.9, 25.4, "fills 1152"), (1.0, 3.81, 25.4, "fills 1152"),  # neither its volume nor nodes at its radius
    ],
)  # fmt: skip
def test_a_mesh_of_another_rod_is_refused(tmp_path: Path, unit: float, radius: float, length: float, message: str):
    path = saved(grid_of(ROD.position, ROD.cells), tmp_path / "rod.vtu")
    with pytest.raises(vp.InputError, match=message):
        read_rod(path, unit, radius, length)


def call(*words: str | Path) -> tuple[int, str]:
    """Run the command line in this process; return exit code and messages."""
    result = CliRunner().invoke(app, ["run", *map(str, words), "--out", "run"])
    assert result.exception is None or isinstance(result.exception, SystemExit), result.exception
    assert result.stdout == ""
    return result.exit_code, result.stderr


@pytest.mark.parametrize(
    ("suffix", "content"),
    [
        ("vtu", b""),
        ("vtu", GARBAGE),
        ("vtk", GARBAGE),
        ("vtkhdf", b""),
        ("exo", GARBAGE),
    ],
)
def test_a_file_that_is_no_mesh_gives_one_message_without_a_word_of_vtk(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str], suffix: str, content: bytes
):
    monkeypatch.chdir(tmp_path)
    mesh = Path(f"rod.{suffix}")
    mesh.write_bytes(content)
    code, messages = call("paper", "--set", f"method={{name='fem', mesh='{mesh}'}}")
    assert (code, messages.count("\n")) == (2, 1)
    assert messages.startswith(f"viscopoint: method.mesh: {mesh}: cannot be read")
    assert capfd.readouterr() == ("", "")
    assert list(tmp_path.iterdir()) == [tmp_path / mesh]


@pytest.mark.parametrize("suffix", ["vtu", "vtk", "vtkhdf"])
@pytest.mark.parametrize("share", [0.5, 0.95])
def test_a_file_that_was_cut_short_is_refused_though_vtk_may_crash_on_it(tmp_path: Path, suffix: str, share: float):
    path = saved(grid_of(ROD.position, ROD.cells), tmp_path / f"rod.{suffix}")
    whole = path.read_bytes()
    path.write_bytes(whole[: int(share * len(whole))])
    with pytest.raises(vp.InputError, match=r"method.mesh: .*: (cannot be read|holds no hexahedra that can be read)"):
        read_rod(path, 1.0, RADIUS, LENGTH)


@pytest.mark.parametrize(
    ("method", "message"),
    [
        ("{name='fem', mesh='none.vtu'}", "method.mesh: none.vtu: there is no such file"),
        ("{name='fem', mesh='.'}", "method.mesh: .: there is no such file"),
        (f"{{name='fem', mesh='{'x' * 300}.vtu'}}", "x.vtu: there is no such file"),
        ("{name='fem', mesh='rod.stl'}", "method.mesh: rod.stl: unknown format '.stl'; allowed: .vtu, .vtk, .vtkhdf"),
        ("{name='fem', mesh='rod.stl', size='1 mm'}", "method.size: cannot be given with method.mesh"),
        ("{name='fem'}", "method.size: is missing; write an element size"),
        ("{name='fem', mesh='rod.stl', mesh_unit='1 s'}", 'method.mesh_unit: "1 s" has the wrong dimension'),
        ("{name='fem', mesh=3}", "method.mesh: 3 must be text in quotes"),
    ],
)
def test_a_wrong_mesh_key_gives_one_message_and_code_2_and_writes_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, method: str, message: str
):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "rod.stl").write_text("solid rod")
    code, messages = call("paper", "--set", f"method={method}")
    assert code == 2
    assert message in messages
    assert list(tmp_path.iterdir()) == [tmp_path / "rod.stl"]


def test_without_pyvista_the_message_says_what_to_install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    path = saved(grid_of(ROD.position, ROD.cells), tmp_path / "rod.vtu")
    monkeypatch.setattr("importlib.util.find_spec", {}.get)
    with pytest.raises(vp.InputError, match=r"pip install 'viscopoint\[mesh\]'"):
        read_rod(path, 1.0, RADIUS, LENGTH)
