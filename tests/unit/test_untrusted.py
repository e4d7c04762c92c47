"""Cases, meshes and run folders that came from others."""

import json
import os
import re
import shutil
import struct
import sys
import time
import zlib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import h5py
import pytest
import pyvista
from hypothesis import given
from hypothesis import strategies as st
from typer.testing import CliRunner

import viscopoint as vp
from viscopoint.case.case import changes_of
from viscopoint.command_line.cli import app
from viscopoint.comparison import Comparison
from viscopoint.errors import CaseError
from viscopoint.messages import one_line, unseen
from viscopoint.methods.fem import reading
from viscopoint.methods.fem.rod import layers, rod_mesh
from viscopoint.results.output.fields import INDEX
from viscopoint.results.safe_read import contents, table, toml

ESCAPES = "\x1b[2J\x1b]0;owned\x07"
FIRST = "fields/fields_00000.vtkhdf"
SECONDS = 5.0  # that any refusal may take
ROD = rod_mesh(2.0, 4.0, 2.0)


@pytest.fixture(autouse=True)
def in_time() -> Iterator[None]:
    began = time.monotonic()
    yield
    assert time.monotonic() - began < 6 * SECONDS  # of a machine that is busy


def refused(file: Path, text: str) -> str:
    file.write_text(text, encoding="utf-8")
    with pytest.raises(vp.InputError) as caught:
        vp.Case.load(file)
    told = str(caught.value)
    assert unseen(told.replace("\n", "")) is None
    assert len(told) < 20_000
    return told


# --- text ---


@given(st.text())
def test_one_line_shows_what_acts_and_leaves_the_rest(text: str):
    shown = one_line(text)
    assert unseen(shown) is None
    assert (shown == text) == (unseen(text) is None)
    shown.encode()


def test_a_message_with_escapes_shows_them(tmp_path: Path):
    error = vp.InputError(f"run folder {ESCAPES}:\n\udcff \u202e")
    assert str(error) == "run folder \\x1b[2J\\x1b]0;owned\\x07:\n\\udcff \\u202e"


@pytest.mark.parametrize("title", [ESCAPES, "two\nlines", "\u202eabc", "a\u2028b", "\x85"])
def test_a_title_that_would_act_on_a_terminal_is_refused(tmp_path: Path, title: str):
    told = refused(tmp_path / "case.toml", f'extends = "paper"\ntitle = {json.dumps(title)}\n')
    assert "title: " in told
    assert "which does not show; write one line of text" in told


@pytest.mark.parametrize(
    "title", ["$\\frac{1}{$ [bold]red[/] :skull: <b>", "Stab, 150 m/s – β = 650", "\u0645\u06cc\u200c\u062e"]
)
def test_any_other_title_is_shown_as_it_is(tmp_path: Path, finished: Path, title: str):
    run = shutil.copytree(finished, tmp_path / "run")
    case = vp.Case.load(run / "case.toml", {"title": title})
    (run / "case.toml").write_text(case.to_toml(), encoding="utf-8")
    assert title in CliRunner().invoke(app, ["show", str(run)]).stdout.splitlines()
    assert vp.Run(run).draw()


# --- cases ---


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("a" + ".a" * 400_000 + " = 1", "a key in it has too many parts"),
        ("[ " + '"b" . ' * 60 + "c]", "a key in it has too many parts"),
        ("rod.radius = " + "9" * 5000, "an integer in it is too large"),
        ("rod.radius = 0x" + "f" * 5000, "an integer in it is too large"),
        ("a = " + "[" * 100_000, "nested too deeply"),
        ("time.snapshots = [" + '"x", ' * 190_000 + "]", "has too many entries"),
        ("time.snapshots = [" + '"9 ly", ' * 9_999 + "]", "and 9899 more"),
        ("".join(f"a{number} = 1\n" for number in range(80_000)), "and 79900 more"),
        (f'{json.dumps(ESCAPES)} = "{"x" * 10_000}"', r'"\u001b[2J'),
        (f'material.law = "{"elastic" * 10_000}"', "elastic' is not known; allowed: elastic, elastic-plastic"),
    ],
)
def test_a_hostile_case_is_refused_at_once_and_in_few_words(tmp_path: Path, text: str, words: str):
    assert words in refused(tmp_path / "case.toml", f'extends = "paper"\n{text}\n')


def test_dots_in_text_are_no_key_of_many_parts():
    text = f'title = "{"a. " * 60}"\n# {"." * 100}\nsnapshots = [{"1.5, " * 100}]\n'
    assert toml(text)["title"].count(".") == 60


def test_changes_that_are_no_toml_are_bare_text():
    settings = ["rod.radius=4 mm", "a=[1, 2]", "b=" + "9" * 5000, "c=" + "[" * 5000, "d.e='x'"]
    assert changes_of(settings) == {
        "rod.radius": "4 mm", "a": [1, 2], "b": "9" * 5000, "c": "[" * 5000, "d.e": "x",
    }  # fmt: skip
    with pytest.raises(vp.InputError, match="nested too deeply"):
        vp.Case.load("paper", {"a" + ".b" * 5000: 1})


def test_a_pipe_where_a_case_should_be_is_refused(tmp_path: Path):
    os.mkfifo(tmp_path / "case.toml")
    with pytest.raises(vp.InputError, match=r"case\.toml: cannot be read \(not a regular file\)"):
        vp.Case.load(tmp_path / "case.toml")


def test_layers_of_a_mesh_that_fits_no_machine_are_counted_at_once():
    assert layers(1e15, 1e-3, 1.0) == pytest.approx(1e18, rel=1e-6)


# --- run folders ---


@pytest.fixture
def received(finished: Path, tmp_path: Path) -> Path:
    """A run folder that somebody else may have changed."""
    return shutil.copytree(finished, tmp_path / "received")


def put(folder: Path, name: str, **changes: object) -> None:
    tables = json.loads((folder / name).read_text())
    (folder / name).write_text(json.dumps(tables | changes))


def shown(folder: Path) -> tuple[int, str]:
    """Return exit code and all words of ``viscopoint show``."""
    result = CliRunner().invoke(app, ["show", str(folder)])
    assert result.exception is None or isinstance(result.exception, SystemExit), result.exception
    return result.exit_code, result.output


@pytest.mark.parametrize("name", ["provenance.json", "summary.json", "case.toml", "history.csv", FIRST, INDEX])
@pytest.mark.parametrize("kind", ["pipe", "link", "circle", "folder", "device"])
def test_what_is_no_file_of_the_run_folder_is_not_opened(received: Path, name: str, kind: str):
    path, outside = received / name, received.parent / "outside"
    path.rename(outside)
    if kind == "pipe":
        os.mkfifo(path)
    elif kind == "folder":
        path.mkdir()
    else:
        path.symlink_to({"link": outside, "circle": path, "device": "/dev/zero"}[kind])
    with pytest.raises(vp.InputError, match=re.escape(name)):
        _ = vp.Run(received).case, vp.Run(received).columns, vp.Run(received).snapshot(0)


def point_elsewhere(file: Any, outside: Path) -> None:
    del file["VTKHDF/Points"]
    file["VTKHDF/Points"] = h5py.ExternalLink(str(outside), "VTKHDF/Points")


def point_inside(file: Any, outside: Path) -> None:
    del file["VTKHDF/Points"]
    file["VTKHDF/Points"] = h5py.SoftLink("/VTKHDF/PointData/velocity")


def keep_data_elsewhere(file: Any, outside: Path) -> None:
    count = outside.stat().st_size // 24
    del file["VTKHDF/Points"]
    file["VTKHDF"].create_dataset("Points", (count, 3), float, external=[(str(outside), 0, 24 * count)])


def make_up_of_others(file: Any, outside: Path) -> None:
    shape = file["VTKHDF/Points"].shape
    layout = h5py.VirtualLayout(shape, float)
    layout[:] = h5py.VirtualSource(str(outside), "VTKHDF/Points", shape)
    del file["VTKHDF/Points"]
    file["VTKHDF"].create_virtual_dataset("Points", layout)


def promise_points(file: Any, outside: Path) -> None:
    del file["VTKHDF/Points"]
    file["VTKHDF"].create_dataset("Points", (10**10, 3), float, maxshape=(None, 3), chunks=(1000, 3))


def compress_in_large_parts(file: Any, outside: Path) -> None:
    data = file["VTKHDF/Points"][()]
    del file["VTKHDF/Points"]
    file["VTKHDF"].create_dataset("Points", data.shape, float, maxshape=(None, 3), chunks=(10**8, 3), compression=1)


def store_text(file: Any, outside: Path) -> None:
    del file["VTKHDF/Points"]
    file["VTKHDF/Points"] = ["text"] * 10


def lose_a_row(file: Any, outside: Path) -> None:
    velocity = file["VTKHDF/PointData/velocity"][:-1]
    del file["VTKHDF/PointData/velocity"]
    file["VTKHDF/PointData/velocity"] = velocity


# of the temporal files of older formats


def count_in_text(file: Any) -> None:
    file["VTKHDF/Steps"].attrs["NSteps"] = "2"


def count_too_far(file: Any) -> None:
    file["VTKHDF/Steps"].attrs["NSteps"] = 10**9


def make_pairs_of_times(file: Any) -> None:
    times = file["VTKHDF/Steps/Values"][()]
    del file["VTKHDF/Steps/Values"]
    file["VTKHDF/Steps"].create_dataset("Values", data=[times, times], maxshape=(None, None))


def compress_twice(file: Any, outside: Path) -> None:
    low: Any = h5py
    created = low.h5p.create(low.h5p.DATASET_CREATE)
    created.set_chunk((100, 3))
    created.set_deflate(9)
    created.set_deflate(9)
    del file["VTKHDF/Points"]
    space = low.h5s.create_simple((100, 3), (low.h5s.UNLIMITED, 3))
    low.h5d.create(file["VTKHDF"].id, b"Points", low.h5t.NATIVE_DOUBLE, space, created)


def compress_what_grows(file: Any, outside: Path) -> None:
    shape = file["VTKHDF/Points"].shape
    del file["VTKHDF/Points"]
    pieces = {"maxshape": (None, 3), "chunks": (100_000, 3), "compression": 1}
    points = file["VTKHDF"].create_dataset("Points", shape, float, **pieces)
    points.id.write_direct_chunk((0, 0), zlib.compress(bytes(2**27), 9))


def compress_what_is_damaged(file: Any, outside: Path) -> None:
    compress_what_grows(file, outside)
    file["VTKHDF/Points"].id.write_direct_chunk((0, 0), bytes(2**17))


def nest(file: Any, outside: Path) -> None:
    group = file["VTKHDF"]
    for _ in range(3000):
        group = group.create_group("g")


def name_many(file: Any, outside: Path) -> None:
    for number in range(3000):
        file.create_group(f"{number}")


def name_itself(file: Any, outside: Path) -> None:
    file["VTKHDF/again"] = file["VTKHDF"]


def make_a_group_of_a_field(file: Any, outside: Path) -> None:
    del file["VTKHDF/PointData/velocity"]
    file["VTKHDF/PointData"].create_group("velocity")


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (point_elsewhere, "lies elsewhere"),
        (point_inside, "lies elsewhere"),
        (keep_data_elsewhere, "lies elsewhere"),
        (make_up_of_others, "lies elsewhere"),
        (promise_points, "holds more than can be in the file"),
        (compress_in_large_parts, "holds more than can be in the file"),
        (store_text, "holds no numbers"),
        (lose_a_row, "is of another length"),
        (compress_twice, "is compressed as none of ours"),
        (compress_what_grows, "has a piece that grows"),
        (compress_what_is_damaged, "has a piece that grows, or is damaged"),
        (nest, "holds more groups than any of ours"),
        (name_many, "holds more groups than any of ours"),
        (name_itself, "holds more groups than any of ours"),
        (make_a_group_of_a_field, "'Group' object has no attribute"),
    ],
)
def test_fields_of_what_is_not_in_their_file_are_refused(
    received: Path, change: Callable[[Any, Path], None], words: str
):
    outside, path = received.parent / "outside", received / FIRST
    shutil.copy(path, outside)
    before = outside.read_bytes()
    with h5py.File(path, "r+") as file:
        change(file, outside)
    with pytest.raises(vp.InputError, match=rf"{FIRST} cannot be read \(.*{words}"):
        vp.Run(received).snapshot(0)
    assert outside.read_bytes() == before


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (count_in_text, "the number of snapshots is none"),
        (count_too_far, "1000000000 snapshots are more than a run can have"),
        (make_pairs_of_times, "the times of its snapshots are none"),
    ],
)
def test_older_fields_whose_times_are_none_are_refused(tmp_path: Path, change: Callable[[Any], None], words: str):
    shutil.unpack_archive(Path(__file__).parent / "older" / "format-6.zip", tmp_path / "older")
    with h5py.File(tmp_path / "older" / "fields.vtkhdf", "r+") as file:
        change(file)
    with pytest.raises(vp.InputError, match=words):
        vp.Run(tmp_path / "older").snapshot(-1)


def test_older_fields_that_a_killed_process_left_half_changed_are_refused(tmp_path: Path):
    shutil.unpack_archive(Path(__file__).parent / "older" / "format-6.zip", tmp_path / "older")
    (tmp_path / "older" / ".fields.vtkhdf.journal").write_bytes(b"viscopoint journal\n")
    with pytest.raises(vp.InputError, match="a snapshot was being written as its process was killed"):
        vp.Run(tmp_path / "older").snapshot(-1)


@pytest.mark.parametrize(
    ("files", "words"),
    [
        (None, "it lists no files"),
        ([{"name": FIRST, "time": "0"}], "the times of its snapshots are none"),
        ([{"name": FIRST, "time": True}], "the times of its snapshots are none"),
        ([{"name": FIRST}], "the times of its snapshots are none"),
        ([FIRST], "the times of its snapshots are none"),
        ([{"name": "../outside.vtkhdf", "time": 0.0}], "it lists other files"),
        ([{"name": FIRST, "time": 1.0}, {"name": FIRST, "time": 2.0}], "it lists other files"),
    ],
)
def test_an_index_of_what_is_none_of_our_snapshots_is_refused(received: Path, files: object, words: str):
    put(received, INDEX, files=files)
    with pytest.raises(vp.InputError, match=words):
        vp.Run(received).snapshot(-1)


def test_a_snapshot_that_does_not_fit_into_memory_is_refused(received: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("viscopoint.model.memory.free", lambda: 1000.0)
    with pytest.raises(vp.InputError, match=r"the snapshot takes .* GiB, there are 9\.31e-07"):
        vp.Run(received).snapshot(-1)


@pytest.mark.parametrize("name", ["provenance.json", "summary.json", "case.toml", "history.csv"])
def test_a_file_larger_than_any_of_ours_is_not_read(received: Path, name: str):
    os.truncate(received / name, 2**40)
    with pytest.raises(vp.InputError, match="larger than"):
        _ = vp.Run(received).case, vp.Run(received).columns


@pytest.mark.parametrize(
    "text",
    ["[" * 100_000, '{"a":' * 100_000, '{"format": ' + "9" * 5000 + "}", "[" + "[]," * 10**6, '{"a": 1e400', "[]"],
)
def test_json_of_any_shape_is_a_table_or_an_error(text: str):
    with pytest.raises(ValueError, match=r"deep|too large|more than 100,000|holds no table|delimiter|Expecting"):
        table(text.encode())


def test_what_a_summary_says_does_not_act_on_a_terminal(received: Path):
    put(received, "summary.json", status="stopped", reason=ESCAPES + "[red] :skull:")
    code, words = shown(received)
    assert code == 0
    assert "INCOMPLETE (\\x1b[2J\\x1b]0;owned\\x07[red] :skull:)" in words
    assert "\x1b" not in words


@pytest.mark.parametrize("change", [{"steps": 10**400}, {"points": 10**30}, {"elements": 2**70}])
def test_a_number_too_large_for_a_summary_is_refused(received: Path, change: dict[str, int]):
    put(received, "summary.json", **change)
    with pytest.raises(vp.InputError, match=r"summary\.json cannot be read \(an integer in it is too large\)"):
        vp.Run(received)


@pytest.mark.parametrize("change", [{"sources": [1]}, {"commit": {}}, {"resumed": 5}, {"ended": 3}])
def test_provenance_of_other_types_is_refused(received: Path, change: dict[str, object]):
    put(received, "provenance.json", **change)
    with pytest.raises(vp.InputError, match=rf"provenance\.json is not that of a run: see {next(iter(change))}"):
        vp.Run(received)


def test_escapes_in_a_commit_do_not_reach_the_terminal(received: Path, finished: Path):
    put(received, "provenance.json", sources="other", commit=ESCAPES)
    made = Comparison((vp.Run(finished), vp.Run(received)), ("one", "other"), (), (), ())
    assert "\\x1b[2J" in made.warnings()[0]
    assert "\x1b" not in made.warnings()[0]


@pytest.mark.parametrize("mesh", ["../mesh.vtu", "/mesh.vtu", "sub/mesh.vtu", "mesh.vtu"])
def test_a_run_folder_s_case_takes_no_mesh_from_elsewhere(received: Path, mesh: str):
    (received.parent / "mesh.vtu").touch()
    (received / "mesh.vtu").symlink_to("../mesh.vtu")
    (received / "case.toml").write_text(f'extends = "paper"\n[method]\nname = "fem"\nmesh = "{mesh}"\n')
    with pytest.raises(CaseError, match=r'method\.mesh: ".*mesh\.vtu" leads out of the run folder'):
        _ = vp.Run(received).case
    with pytest.raises(CaseError, match="leads out of the run folder"):
        vp.Case.load(received / "case.toml")


def test_the_name_of_a_folder_acts_on_nothing(finished: Path, tmp_path: Path):
    folder = shutil.copytree(finished, tmp_path / f"{ESCAPES.replace('/', '')}\udcff\u202e")
    code, words = shown(folder)
    assert code == 0
    assert "\\x1b[2J\\x1b]0;owned\\x07\\udcff\\u202e" in words.replace("\n", "")
    result = CliRunner().invoke(app, ["compare", str(finished), str(folder), "--out", str(tmp_path / "comparison")])
    assert (result.exit_code, unseen(result.output.replace("\n", ""))) == (0, None), result.output


@pytest.mark.parametrize(
    "content",
    ['"' + "a" * 200_000 + '"\n1\n', "x" * 10**6, "time [ms]\n" + "x" * 10**6, "\0" * 9, "1\n" + "1," * 10**6],
)
def test_a_history_that_is_no_table_is_refused_in_few_words(received: Path, content: str):
    (received / "history.csv").write_text(content)
    with pytest.raises(vp.InputError, match=r"history\.csv cannot be read") as caught:
        _ = vp.Run(received).columns
    assert len(str(caught.value)) < 500


def test_figures_are_not_drawn_through_a_link(received: Path):
    shutil.rmtree(received / "figures", ignore_errors=True)
    (received.parent / "elsewhere").mkdir()
    (received / "figures").symlink_to("../elsewhere")
    with pytest.raises(vp.InputError, match="figures has links"):
        vp.Run(received).draw()
    (received / "figures").unlink()
    (received / "figures").mkdir()
    (received / "figures" / ".shapes.png.part").symlink_to("../../elsewhere/shapes.png")
    with pytest.raises(vp.InputError, match="figures has links"):
        vp.Run(received).draw()
    assert not any((received.parent / "elsewhere").iterdir())


def test_contents_are_bounded_whatever_the_size_says():
    with pytest.raises(ValueError, match="larger than 10 bytes"):
        contents(Path(__file__), 10)


# --- meshes ---


def cannot_be_read(path: Path) -> str:
    began = time.monotonic()
    with pytest.raises(vp.InputError, match=r"method\.mesh: ") as caught:
        reading.read_rod(path, 1.0, 2.0, 4.0)
    assert time.monotonic() - began < 4 * SECONDS  # PyVista's start on a busy machine included
    return str(caught.value)


def test_a_mesh_in_other_files_is_refused(tmp_path: Path):
    grid = pyvista.UnstructuredGrid({pyvista.CellType.HEXAHEDRON: ROD.cells}, ROD.position)
    grid.save(tmp_path / "whole.vtkhdf")
    shutil.copy(tmp_path / "whole.vtkhdf", tmp_path / "rod.vtkhdf")
    with h5py.File(tmp_path / "rod.vtkhdf", "r+") as file:
        del file["VTKHDF/Points"]
        file["VTKHDF/Points"] = h5py.ExternalLink(str(tmp_path / "whole.vtkhdf"), "VTKHDF/Points")
    assert "refers to other files; a mesh must be whole in one" in cannot_be_read(tmp_path / "rod.vtkhdf")


@pytest.mark.parametrize(("far", "words"), [(1e20, r"reach 1e\+20 mm"), (float("nan"), "not all finite")])
def test_coordinates_beyond_any_length_are_refused_without_a_warning(tmp_path: Path, far: float, words: str):
    position = ROD.position.copy()
    position[3, 0] = far
    pyvista.UnstructuredGrid({pyvista.CellType.HEXAHEDRON: ROD.cells}, position).save(tmp_path / "rod.vtu")
    assert re.search(words, cannot_be_read(tmp_path / "rod.vtu"))


def test_a_header_that_promises_more_cells_than_a_machine_holds_is_refused(tmp_path: Path):
    head = "# vtk DataFile Version 3.0\nx\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 3000 3000 3000\n"
    (tmp_path / "rod.vtk").write_text(head + "ORIGIN 0 0 0\nSPACING 1 1 1\n")
    assert "holds more than 50,000,000 elements" in cannot_be_read(tmp_path / "rod.vtk")


def test_a_file_that_takes_more_memory_than_it_may_is_refused(tmp_path: Path):
    head = "# vtk DataFile Version 3.0\nx\nBINARY\nDATASET UNSTRUCTURED_GRID\nPOINTS 600000000 double\n"
    (tmp_path / "rod.vtk").write_bytes(head.encode() + struct.pack(">d", 1.0) * 9)
    assert re.search("cannot be read|holds no hexahedra that can be read", cannot_be_read(tmp_path / "rod.vtk"))


@pytest.mark.parametrize(
    ("code", "words"),
    [
        ("while True: pass", "takes longer to read than a mesh of its size"),
        ("bytearray(3 * 2**30)", "cannot be read"),
        ("print('x' * 10**7); open('out', 'wb').truncate(2**33)", "cannot be read"),
    ],
)
def test_the_process_that_reads_has_limits(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str], code: str, words: str
):
    program = tmp_path / "program.py"
    program.write_text(
        f"import sys\nsys.path.append({str(reading.PROGRAM.parent)!r})\n"
        f"import vtk_program\nvtk_program.limit(1)\n{code}\n"
    )
    (tmp_path / "rod.vtu").touch()
    monkeypatch.setattr(reading, "PROGRAM", program)
    assert words in cannot_be_read(tmp_path / "rod.vtu")
    assert capfd.readouterr() == ("", "")


def test_a_file_that_waits_for_ever_is_given_up(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    (tmp_path / "program.py").write_text("import time\ntime.sleep(60)\n")
    (tmp_path / "rod.vtu").touch()
    monkeypatch.setattr(reading, "PROGRAM", tmp_path / "program.py")
    monkeypatch.setattr(reading, "SECONDS", 0.3)
    assert "takes longer to read" in cannot_be_read(tmp_path / "rod.vtu")


def test_a_file_larger_than_any_mesh_is_refused_before_it_is_opened(tmp_path: Path):
    (tmp_path / "rod.vtu").touch()
    os.truncate(tmp_path / "rod.vtu", 2**40)
    assert "1024.0 GiB; allowed are 4 GiB" in cannot_be_read(tmp_path / "rod.vtu")


if sys.platform == "win32":  # no pipes in folders, no limits of processes
    pytest.skip("of Unix", allow_module_level=True)
