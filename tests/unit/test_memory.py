"""A case that does not fit into memory is refused before it takes any, and a run that finds none left can go on."""

import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

import viscopoint as vp
from viscopoint.methods.mpm import grid
from viscopoint.model import memory
from viscopoint.model.build import build
from viscopoint.model.memory import Need
from viscopoint.results.verify import compare_bits

GIB = 2**30
FLAT = {"method.geometry": "axisymmetric"}


# --- refused before anything is taken ---


@pytest.mark.parametrize(
    ("method", "changes", "words"),
    [
        ("mpm", {"method.spacing": "1 nm"}, r"method\.spacing: 1e-06 mm gives 1\.2e\+21 points, about "),
        ("tlmpm", FLAT | {"method.spacing": "0.1 um"}, r"method\.spacing: 0\.0001 mm gives 9\.7e\+09 points, about "),
        ("fem", FLAT | {"method.size": "0.1 um"}, r"method\.size: 0\.0001 mm gives 9\.7e\+09 elements, about "),
        ("fem", {"method.size": "1e-7 mm", "rod.length": "1e8 mm"}, r"GiB; there are .*: take a larger one"),
    ],
)
def test_what_fits_into_no_machine_is_refused(method: str, changes: dict[str, Any], words: str, tmp_path: Path):
    case = vp.Case.load("paper", changes, method=method)
    with pytest.raises(vp.InputError, match=words):
        vp.run(case, tmp_path / "run")
    assert not list(tmp_path.iterdir())


@pytest.mark.skipif(sys.platform != "linux", reason="other systems do not hold a process to its address space")
@pytest.mark.parametrize(("method", "key"), [("mpm", "spacing"), ("tlmpm", "spacing"), ("fem", "size")])
def test_a_limit_of_the_process_is_what_counts(method: str, key: str, tmp_path: Path):
    limited = f"import resource; resource.setrlimit(resource.RLIMIT_AS, (2 * {GIB}, 2 * {GIB}))"
    words = ["run", "paper", "--method", method, "--set", f"method.{key}=0.06 mm", "--out", "run"]
    script = f"{limited}\nfrom viscopoint.command_line.cli import app\napp({words})"
    done = subprocess.run([sys.executable, "-c", script], cwd=tmp_path, capture_output=True, text=True, check=False)
    told = " ".join(done.stderr.split())
    assert done.returncode == 2, told
    assert told.startswith(f"viscopoint: method.{key}: 0.06 mm gives ")
    assert "take a larger one" in told
    assert not list(tmp_path.iterdir())


def test_elements_of_a_file_are_counted_when_they_are_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    import pyvista

    from viscopoint.methods.fem.rod import rod_mesh

    rod = rod_mesh(3.8, 25.4, 1.2)
    pyvista.UnstructuredGrid({pyvista.CellType.HEXAHEDRON: rod.cells}, rod.position).save(tmp_path / "rod.vtu")
    case = vp.Case.load("paper", {"method": {"name": "fem", "mesh": str(tmp_path / "rod.vtu")}})
    monkeypatch.setattr(memory, "free", lambda: 1000.0 * len(rod.cells))
    with pytest.raises(vp.InputError, match=r"method\.mesh: .*rod\.vtu has .* elements, about .*: take a mesh"):
        build(case)


def test_memory_that_is_gone_in_spite_of_the_estimate_is_told_in_the_same_words(monkeypatch: pytest.MonkeyPatch):
    case = vp.Case.load("paper", {"method.spacing": "0.72 mm", "method.cell": "1 mm"})
    monkeypatch.setattr(memory, "free", lambda: 1e12)
    monkeypatch.setattr("viscopoint.methods.mpm.method.lattice", _no_memory)
    with pytest.raises(vp.InputError, match=r"method\.spacing: 0\.72 mm gives .* points: there was no memory left"):
        build(case)


def _no_memory(*_: Any) -> None:
    raise MemoryError


# --- what there is ---


def control_group(folder: Path, files: dict[str, str]) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in files.items():
        (folder / name).write_text(f"{text}\n")


def test_limits_of_control_groups_count_and_so_do_those_around_them(tmp_path: Path):
    control_group(
        tmp_path / "outer",
        {"memory.max": "8000", "memory.current": "5000", "memory.stat": "anon 4000\ninactive_file 700"},
    )
    control_group(
        tmp_path / "outer" / "inner", {"memory.max": "max", "memory.current": "900", "memory.stat": "inactive_file 0"}
    )
    (tmp_path / "mine").write_text("0::/outer/inner\n")
    assert list(memory._group_limits(tmp_path, tmp_path / "mine")) == [(8000.0, 4300.0)]


def test_limits_of_the_first_version_count_where_a_container_shows_only_its_own_group(tmp_path: Path):
    control_group(
        tmp_path / "memory",
        {"memory.limit_in_bytes": "8000", "memory.usage_in_bytes": "5000", "memory.stat": "total_inactive_file 700"},
    )
    (tmp_path / "mine").write_text("3:cpu:/\n2:hugetlb,memory:/docker/42\n")
    assert list(memory._group_limits(tmp_path, tmp_path / "mine")) == [(8000.0, 4300.0)]


def test_what_fits_exactly_is_taken():
    need = Need("method.size", "0.1 mm gives 7 elements", 3.0 * GIB)
    memory.check(need, 3.0 * GIB)
    with pytest.raises(vp.InputError, match=r"^method\.size: 0\.1 mm gives 7 elements, about 3 GiB; there are 2: take"):
        memory.check(need, 2.0 * GIB)


# --- while it runs ---

SCARCE = """
import resource, sys
import psutil
import viscopoint as vp

def watch(share, row):
    if row.time > 1.5e-3:
        resource.setrlimit(resource.RLIMIT_AS, (psutil.Process().memory_info().vms + 400_000, resource.RLIM_INFINITY))

changes = {"time.end": "4 us", "time.snapshots": ["1 us", "2 us"], **dict([sys.argv[2].split("=")])}
case = vp.Case.load("paper", changes, method=sys.argv[1])
try:
    vp.run(case, "run", figures=False, checkpoint_every="0.5 us simulated", watch=watch if sys.argv[3:] else None)
except vp.OutputError as error:
    print(error)
"""


@pytest.mark.skipif(sys.platform != "linux", reason="other systems do not hold a process to its address space")
@pytest.mark.parametrize(
    "words",
    [
        ("tlmpm", "method.spacing=0.3 mm"),
        pytest.param(("fem", "method.size=0.3 mm"), marks=pytest.mark.long),
    ],
)
def test_a_run_that_finds_no_memory_keeps_what_it_has_and_goes_on_when_there_is_some(
    words: tuple[str, str], tmp_path: Path
):
    line = [sys.executable, "-c", SCARCE, *words]
    mapped = os.environ | {"MALLOC_MMAP_THRESHOLD_": "65536"}  # arrays are never taken of what others gave back
    done = subprocess.run([*line, "scarce"], cwd=tmp_path, capture_output=True, text=True, check=False, env=mapped)
    assert done.returncode == 0, done.stderr
    assert "memory ran out" in done.stdout
    assert "once that is mended, `viscopoint resume run` goes on" in done.stdout
    assert vp.Run(tmp_path / "run").status == "interrupted"
    run = vp.resume(tmp_path / "run", figures=False)
    assert run.status == "complete"
    (tmp_path / "whole").mkdir()
    subprocess.run(line, cwd=tmp_path / "whole", check=True)
    assert compare_bits(vp.Run(tmp_path / "whole" / "run"), run).same


def test_points_that_scatter_stop_a_run_before_their_grid_takes_all_memory(monkeypatch: pytest.MonkeyPatch):
    changes = {"method.spacing": "0.72 mm", "method.cell": "1 mm", "time.end": "100 us", "time.snapshots": []}
    case = vp.Case.load("paper", changes)
    need = case.method.need(case.rod).size
    monkeypatch.setattr(grid, "NEGLIGIBLE", 0.0)
    there = [1e12, 1e12]  # for the estimate and the first grid
    monkeypatch.setattr(memory, "free", lambda: there.pop() if there else 0.01 * need)
    run = vp.run(case, figures=False)
    assert run.status == "stopped"
    assert "the stable step fell to 0 us" in run.results.reason
    assert "the grid around points from" in run.results.reason
    assert "points fly apart" in run.results.reason
    assert run.rows[-1].time > 0.0


# --- the estimates ---

GROWTH = """
import sys
import viscopoint as vp
from viscopoint.bench.growth import peak

def start(key, value, folder):
    changes = {"time.end": "0.5 us", "time.snapshots": ["0.1 us"], **choices, key: value}
    case = vp.Case.load("paper", changes, method=method)
    count = []
    def end(share, row):
        count.append(row)
        if len(count) > 4:
            raise KeyboardInterrupt
    vp.run(case, folder, figures=False, checkpoint_every="1e-9 us simulated", watch=end)
    count.clear()
    vp.resume(folder, figures=False, checkpoint_every="never", watch=end)
    return case

method, key, coarse, fine, *words = sys.argv[1:]
choices = dict(word.split("=") for word in words)
start(key, coarse, "coarse")  # code, and what it needs once
before = peak()
case = start(key, fine, "fine")
print(peak() - before, case.method.need(case.rod).size)
"""
ROUND = "method.geometry=axisymmetric"
ESTIMATED = [
    ("mpm", "method.spacing", "0.72 mm", "0.15 mm", "method.cell=1 mm"),
    ("mpm", "method.spacing", "0.72 mm", "0.15 mm", "method.cell=0.8 mm", "method.shape=gimp", "method.transfer=apic"),
    ("mpm", "method.spacing", "0.4 mm", "0.15 mm", "method.cell=0.4 mm", "method.transfer=apic"),
    ("mpm", "method.spacing", "0.72 mm", "0.01 mm", "method.cell=0.8 mm", ROUND),
    ("tlmpm", "method.spacing", "0.6 mm", "0.15 mm"),
    ("tlmpm", "method.spacing", "0.6 mm", "0.01 mm", ROUND),
    ("fem", "method.size", "1.2 mm", "0.17 mm"),
    ("fem", "method.size", "1.2 mm", "0.17 mm", "method.element=selective"),
    ("fem", "method.size", "1.2 mm", "0.01 mm", ROUND),
    ("fem", "method.size", "1.2 mm", "0.01 mm", "method.element=selective", ROUND),
]


@pytest.mark.long
@pytest.mark.parametrize("words", ESTIMATED, ids=" ".join)
def test_estimates_are_somewhat_more_than_runs_and_resumed_runs_take(words: tuple[str, ...], tmp_path: Path):
    line = [sys.executable, "-c", GROWTH, *words]
    done = subprocess.run(line, cwd=tmp_path, capture_output=True, text=True, check=True)
    grown, estimated = map(float, done.stdout.split())
    print(f"{' '.join(words)}: grew by {grown / GIB:.3f} GiB, estimated {estimated / GIB:.3f}")
    assert 1.0 < estimated / grown < 2.5  # what is taken fits; what is refused needs two fifths of the memory at least
