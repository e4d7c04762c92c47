"""Compiled code: never stale, never mixed up, and compiled again only where it would be another."""

import os
import re
import shutil
import threading
import time
from pathlib import Path
from typing import Any

import pytest
from watched import ALL, BLOCKS, ELASTIC, PACKAGE, WATCH, fill, run_python, start, told

from viscopoint.kernels import cache as kernel_cache
from viscopoint.kernels import cache_folder as folders
from viscopoint.kernels import jit, outside
from viscopoint.kernels.cache_folder import cache_folder

LOADED = str(len(ALL))


def copied(place: Path) -> Path:
    """Return a copy of the package."""
    return Path(shutil.copytree(PACKAGE, place / "viscopoint", ignore=shutil.ignore_patterns("__pycache__")))


def edit(file: Path, old: str, new: str) -> None:
    """Change a text that stands in a file once."""
    text = file.read_text()
    assert text.count(old) == 1
    file.write_text(text.replace(old, new))


def test_an_edited_material_is_never_run_stale_and_a_warm_start_compiles_nothing(
    tmp_path: Path, tmp_path_factory: pytest.TempPathFactory
):
    copy, cold = copied(tmp_path / "copy"), fill(tmp_path / "cache", tmp_path_factory)
    assert run_python(ELASTIC, copy, tmp_path / "cache") == [cold, LOADED]
    edit(copy / "materials" / "__init__.py", "return material.bulk * (", "return 2.0 * material.bulk * (")
    edited, loaded, *compiled = run_python(ELASTIC, copy, tmp_path / "cache")
    assert (loaded, compiled) == ("0", ALL)
    assert float(edited) == 2.0 * float(cold)


NUMERICS = "from viscopoint.kernels.sources import numerics; print(numerics())"
METHOD, POINTS = "methods/mpm/method.py", "model/points.py"  # one with messages, one with a kernel
WORDS = [
    (METHOD, "the body does not stay in the box", "the body went away"),
    (METHOD, '"""The material point method as the driver sees it."""', '"""What the driver sees.\n\nOf MPM.\n"""'),
    (METHOD, '"""The choices that make an MPM."""', '"""What an MPM is made of."""'),
    (METHOD, "# --- the stages of a step ---", "# a step, stage by stage"),
    (METHOD, "class MaterialPointMethod(", "\n\n# one more class\nclass MaterialPointMethod("),
    (POINTS, "@kernel(CHUNKS)", "\n\n# another line number for all that follows\n@kernel(CHUNKS)"),
    (POINTS, '"""Sum over each chunk of points the energies [mJ]', '"""Add up the energies [mJ]'),
]
NUMBERS = [
    (POINTS, "v * load(work, DISSIPATED, i)", "2.0 * v * load(work, DISSIPATED, i)"),
    (POINTS, "-(swept_before * load", "+(swept_before * load"),
    ("materials/elastic.py", "return 0.25 / material.shear", "return 0.24 / material.shear"),
    ("materials/elastic.py", "+ 2.0 * material.shear", "- 2.0 * material.shear"),
    ("materials/linear_viscoelastic.py", "if x > 0.5:", "if x > 0.25:"),
    ("methods/mpm/stress.py", "0.5 * m * dot(v, v)", "0.25 * m * dot(v, v)"),
    ("interactions/rows.py", "lacking / inverse", "lacking * inverse"),
    ("kernels/jit.py", '{"arcp"}', '{"contract"}'),  # a text that makes code
    (
        "materials/elastic.py",
        "    bulk: float  # K, MPa\n    shear: float",
        "    shear: float\n    bulk: float",
    ),  # their order
    ("bench/triad.py", "+ s * c", "- s * c"),
]


def test_an_edit_of_words_compiles_nothing(tmp_path: Path, tmp_path_factory: pytest.TempPathFactory):
    copy, cold = copied(tmp_path / "copy"), fill(tmp_path / "cache", tmp_path_factory)
    before = run_python(NUMERICS, copy, tmp_path)
    for file, old, new in WORDS:
        edit(copy / file, old, new)
        assert run_python(NUMERICS, copy, tmp_path) == before, (file, old)
    assert run_python(ELASTIC, copy, tmp_path / "cache") == [cold, LOADED]


def test_an_edit_of_a_number_or_an_operator_is_another_state_of_the_numerics(tmp_path: Path):
    copy = copied(tmp_path / "copy")
    states = [run_python(NUMERICS, copy, tmp_path)]
    for file, old, new in NUMBERS:
        edit(copy / file, old, new)
        states.append(run_python(NUMERICS, copy, tmp_path))
        assert states[-1] not in states[:-1], (file, old)


def test_code_compiled_after_an_edit_is_of_what_was_imported_and_nobody_else_loads_it(
    tmp_path: Path, tmp_path_factory: pytest.TempPathFactory
):
    copy, cold = copied(tmp_path / "copy"), fill(tmp_path / "cache", tmp_path_factory)
    law = copy / "materials" / "__init__.py"
    edited_meanwhile = (
        "from pathlib import Path; import viscopoint.materials.block\n"
        f"law = Path({str(law)!r})\n"
        "law.write_text(law.read_text().replace('return material.bulk * (', 'return 2.0 * material.bulk * ('))\n"
    )
    old, loaded, *compiled = run_python(edited_meanwhile + ELASTIC, copy, tmp_path / "cache")
    assert (old, loaded, compiled) == (cold, "0", ALL)
    new, loaded, *_ = run_python(ELASTIC, copy, tmp_path / "cache")
    assert loaded == "0"
    assert float(new) == 2.0 * float(cold)


def test_materials_of_one_name_in_two_files_have_code_of_their_own(tmp_path: Path):
    copy = copied(tmp_path / "copy")
    law = (copy / "materials" / "elastic.py").read_text().replace("materials.volume_and_shear_energy", "twice")
    law = law.replace('"elastic"', '"elastic-twice"') + (
        "\n@materials.inline\ndef twice(material, jacobian, stress, history):\n"
        "    return 2.0 * materials.volume_and_shear_energy(material, jacobian, stress, history)\n"
    )
    law = law.replace("implements(materials.stored_energy, Elastic)(twice)\n", "")
    (copy / "materials" / "twice.py").write_text(law + "\nimplements(materials.stored_energy, Elastic)(twice)\n")
    once, _, *_ = run_python(ELASTIC, copy, tmp_path / "cache")
    other = ELASTIC.replace("materials.elastic", "materials.twice")
    twice, loaded, *compiled = run_python(other, copy, tmp_path / "cache")
    assert (loaded, compiled) == ("1", BLOCKS)  # the kernel
    assert float(twice) == 2.0 * float(once)


STEPS_OF = (
    WATCH
    + """
import sys
from viscopoint.case.case import Case
from viscopoint.model.build import build
material, *names = sys.argv[1:] if len(sys.argv) > 1 else WORDS
for name in names:
    changes = {"material": MATERIALS[material], "method.size" if name == "fem" else "method.spacing": "1 mm"}
    case = Case.load("paper", changes if name != "mpm" else changes | {"method.cell": "2 mm"}, method=name)
    method = build(case).method
    for _ in range(2):
        method.advance(method.stable_step())
    method.totals()
print(*files) if material == "plastic" else print(len(loaded), *compiled)
"""
)
MODULI = {"density": "1 g/cm^3", "bulk": "550 MPa"}
PLASTIC = MODULI | {"law": "elastic-plastic", "shear": "140 MPa", "yield_stress": "20 MPa"}
VISCOUS = MODULI | {"law": "linear-viscoelastic", "shear_short": "140 MPa", "shear_long": "4 MPa", "decay": "650 1/ms"}
OF_VISCOUS = {f"{name}_LinearViscoelastic__" for name in ("energies", "prepare", "update")}
MATERIALS = {"plastic": PLASTIC, "viscous": VISCOUS}


def named(file: Path) -> str:
    """Return the name of what a file of code is of."""
    return re.sub("_[0-9a-f]{8}$", "", file.name.partition("-")[0].rpartition(".")[2])


def steps(material: str, *names: str) -> str:
    """Return code that takes some steps of methods with a material."""
    return STEPS_OF.replace("WORDS", repr([material, *names])).replace("MATERIALS", repr(MATERIALS))


@pytest.mark.parametrize("names", [("mpm",), pytest.param(("mpm", "tlmpm", "fem"), marks=pytest.mark.long)])
def test_another_material_in_a_new_process_compiles_no_kernel(names: tuple[str, ...], tmp_path: Path):
    # what the one material used, and no more: most of it other tests have compiled before
    used = [Path(file) for file in run_python(steps("plastic", *names), PACKAGE, cache_folder().parent)]
    folder = tmp_path / cache_folder().name
    folder.mkdir(mode=0o700)
    before = {Path(shutil.copy2(file, folder)) for file in used}
    assert len(before) == len(used)
    kernels = [file for file in used if "Plastic" not in named(file)]
    assert len(kernels) > 5 * len(names)
    loaded, *compiled = run_python(steps("viscous", *names), PACKAGE, tmp_path)
    assert set(compiled) == OF_VISCOUS
    assert int(loaded) == len(kernels)
    added = {named(file) for file in set(tmp_path.rglob("*.code")) - before}
    assert added == OF_VISCOUS
    assert before <= set(tmp_path.rglob("*.code"))


STEPS_OF_ALL = """
import hashlib
from viscopoint.case.case import Case
from viscopoint.model.build import build
for name in ("mpm", "tlmpm", "fem"):
    method = build(Case.load("paper", method=name)).method
    for _ in range(40):
        method.advance(method.stable_step())
    print(hashlib.sha256(b"".join(values.tobytes() for values in method.state().values())).hexdigest())
"""


@pytest.mark.long
def test_code_that_was_just_compiled_gives_the_bits_of_code_from_the_disk(tmp_path: Path):
    compiled = run_python(STEPS_OF_ALL, PACKAGE, tmp_path)
    assert len(compiled) == 3
    assert run_python(STEPS_OF_ALL, PACKAGE, tmp_path) == compiled


def test_processes_that_fill_one_empty_cache_at_once_agree_and_leave_it_whole(tmp_path: Path):
    both = [start(ELASTIC, PACKAGE, VISCOPOINT_CACHE=tmp_path) for _ in range(2)]
    (one, *_), (other, *_) = map(told, both)
    assert one == other
    assert run_python(ELASTIC, PACKAGE, tmp_path) == [one, LOADED]
    assert len([*tmp_path.rglob("*.code")]) == len(ALL)
    assert [*tmp_path.rglob("*.part")] == []


def twice(x: float) -> float:
    return x + x


@pytest.fixture
def kernels(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A cache folder that also keeps kernels of tests."""
    monkeypatch.setattr(kernel_cache, "cache_folder", lambda: tmp_path)
    monkeypatch.setattr(outside, "is_outside", lambda _: False)
    monkeypatch.setattr(outside, "found", [])  # of other tests
    return tmp_path


def test_code_that_two_save_at_once_for_other_arguments_is_neither_lost_nor_mixed_up(
    kernels: Path, monkeypatch: pytest.MonkeyPatch
):
    kernel: Any = jit.serial_kernel(twice)
    assert (kernel(1.0), kernel(1)) == (2.0, 2)
    assert len([*kernels.glob("*.code")]) == 2  # one of each combination of types
    shutil.rmtree(kernels)
    kernels.mkdir()
    saved(kernel, [0, 1], monkeypatch)
    fresh: Any = jit.serial_kernel(twice)
    assert (fresh(0.5), fresh(2), sum(fresh.stats.cache_hits.values())) == (1.0, 4, 2)
    assert fresh.signatures == kernel.signatures
    assert [*kernels.glob("*.part")] == []


def test_code_that_two_save_at_once_for_the_same_arguments_is_whole_whenever_it_is_read(
    kernels: Path, monkeypatch: pytest.MonkeyPatch
):
    kernel: Any = jit.serial_kernel(twice)
    assert kernel(1.0) == 2.0
    [file] = kernels.glob("*.code")
    whole = file.read_bytes()
    file.unlink()
    read: list[bytes] = []
    saved(kernel, [0, 0], monkeypatch, lambda: read.append(file.read_bytes() if file.exists() else b""))
    assert set(read) == {b"", whole}
    assert [*kernels.iterdir()] == [file]


def saved(kernel: Any, which: list[int], monkeypatch: pytest.MonkeyPatch, look: Any = lambda: None) -> None:
    """Let several at once save what a kernel was compiled to, each half done before any goes on; ``look`` in between.

    ``which`` are the combinations of types that they save.
    """
    half, dumps = threading.Barrier(len(which) + 1), kernel_cache.dumps  # pyright: ignore[reportPrivateImportUsage]
    replace = Path.replace

    def slowly(*words: Any) -> bytes:
        half.wait(10.0)  # all have their file open, and nothing in it
        return dumps(*words)

    def when_all_have_written(file: Path, target: Path) -> Path:
        half.wait(10.0)
        return replace(file, target)

    monkeypatch.setattr(kernel_cache, "dumps", slowly)
    monkeypatch.setattr(Path, "replace", when_all_have_written)
    overloads = [*kernel.overloads.items()]
    threads = [
        threading.Thread(target=jit.serial_kernel(twice)._cache.save_overload, args=overloads[number])  # pyright: ignore[reportFunctionMemberAccess]
        for number in which
    ]
    for thread in threads:
        thread.start()
    for _ in range(2):
        look()
        half.wait(10.0)
    for thread in threads:
        thread.join()
    look()


def test_code_that_cannot_be_read_is_compiled_again(kernels: Path):
    kernel: Any = jit.serial_kernel(twice)
    assert kernel(1.0) == 2.0
    [file] = kernels.glob("*.code")
    whole = file.read_bytes()
    for damaged in (b"", whole[: len(whole) // 2]):
        file.write_bytes(damaged)
        fresh: Any = jit.serial_kernel(twice)
        assert fresh(0.5) == 1.0
        assert sum(fresh.stats.cache_hits.values()) == 0
        again: Any = jit.serial_kernel(twice)
        assert (again(0.5), sum(again.stats.cache_hits.values())) == (1.0, 1)


def test_code_of_sources_that_nobody_ran_for_long_is_removed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv("VISCOPOINT_CACHE", str(tmp_path))
    old, recent, other = tmp_path / f"kernels-{16 * 'a'}", tmp_path / f"kernels-{16 * 'b'}", tmp_path / "kernels-mine"
    for folder in (old, recent, other):
        folder.mkdir()
        (folder / "code").touch()
    for folder in (old, other):
        os.utime(folder, (0.0, time.time() - 1.1 * folders.UNUSED))
    used = folders.cache_folder.__wrapped__()
    assert used.parent == tmp_path
    assert sorted(tmp_path.iterdir()) == sorted([recent, other, used])
