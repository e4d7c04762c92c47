import ast
import os
import shutil
import subprocess
import sys
import threading
import time
from pathlib import Path
from typing import Any

import pytest
from numba.core.caching import IndexDataCacheFile

import viscopoint
from viscopoint.kernels import cache as kernel_cache
from viscopoint.kernels import jit, outside

PACKAGE = Path(viscopoint.__file__).parent


def stores(function: ast.FunctionDef) -> list[ast.expr]:
    """Return what the statements of a function assign to."""
    targets: list[ast.expr] = []
    for node in ast.walk(function):
        if isinstance(node, ast.Assign):
            targets += node.targets
        elif isinstance(node, ast.AugAssign):
            targets.append(node.target)
    return targets


def test_no_kernel_stores_through_an_attribute():
    # Numba drops such stores inside prange (see viscopoint.kernels.jit.kernel)
    functions = [
        node
        for source in PACKAGE.rglob("*.py")
        for node in ast.walk(ast.parse(source.read_text()))
        if isinstance(node, ast.FunctionDef) and "kernel" in map(ast.unparse, node.decorator_list)
    ]
    assert len(functions) >= 8
    lost = [
        f"{function.name}: {ast.unparse(target)}"
        for function in functions
        for target in stores(function)
        if isinstance(target, ast.Subscript) and isinstance(target.value, ast.Attribute)
    ]
    assert lost == []


def python(code: str, package: Path, **settings: Path) -> subprocess.Popen[str]:
    """Start code in a new process on a copy of the package, with settings of its own."""
    environment = {key: value for key, value in os.environ.items() if key != "VISCOPOINT_CACHE"}
    environment |= {"PYTHONPATH": str(package.parent), **{key: str(value) for key, value in settings.items()}}
    return subprocess.Popen([sys.executable, "-c", code], env=environment, stdout=subprocess.PIPE, text=True)


def told(process: subprocess.Popen[str]) -> list[str]:
    """Return the words that a process printed."""
    out, _ = process.communicate()
    assert process.returncode == 0
    return out.split()


def run_python(code: str, package: Path, cache: Path) -> list[str]:
    return told(python(code, package, VISCOPOINT_CACHE=cache))


LAW_IN_KERNEL = """
import numpy as np
from viscopoint.kernels.jit import serial_kernel
from viscopoint.materials.elastic import Elastic
from viscopoint.methods.mpm.stress import sum_points
from viscopoint.methods.mpm.points import at_rest
points = at_rest(np.zeros((1, 3)), np.ones(1), np.ones(1), 0)
points.shared.jacobian[:] = 0.9
sums = np.zeros((64, 9))
sum_points(points, Elastic(1e-3, 100.0, 10.0), (), sums)
print(sums[:, 1].sum(), sum(sum_points.stats.cache_hits.values()))
"""


def test_an_edited_law_is_never_run_stale_and_a_warm_start_compiles_nothing(tmp_path: Path):
    copy = tmp_path / "copy" / "viscopoint"
    shutil.copytree(PACKAGE, copy, ignore=shutil.ignore_patterns("__pycache__"))
    cold, hits = run_python(LAW_IN_KERNEL, copy, tmp_path / "cache")
    assert hits == "0"
    warm, hits = run_python(LAW_IN_KERNEL, copy, tmp_path / "cache")
    assert (warm, hits) == (cold, "1")
    law = copy / "materials" / "__init__.py"
    law.write_text(law.read_text().replace("return bulk * (", "return 2.0 * bulk * ("))
    edited, _ = run_python(LAW_IN_KERNEL, copy, tmp_path / "cache")
    assert float(edited) == 2.0 * float(cold)


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
    both = [python(LAW_IN_KERNEL, PACKAGE, VISCOPOINT_CACHE=tmp_path) for _ in range(2)]
    (one, _), (other, _) = map(told, both)
    assert one == other
    assert run_python(LAW_IN_KERNEL, PACKAGE, tmp_path) == [one, "1"]


def twice(x: float) -> float:
    return x + x


def test_code_that_two_save_at_once_for_other_arguments_is_neither_lost_nor_mixed_up(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):  # fmt: skip
    monkeypatch.setattr(jit, "cache_folder", lambda: tmp_path)
    monkeypatch.setattr(kernel_cache, "cache_folder", lambda: tmp_path)
    monkeypatch.setattr(outside, "is_outside", lambda _: False)
    kernel: Any = jit.serial_kernel(twice)
    assert (kernel(1.0), kernel(1)) == (2.0, 2)
    shutil.rmtree(tmp_path)
    tmp_path.mkdir()
    save, load = IndexDataCacheFile._save_data, IndexDataCacheFile._load_index
    waits = iter([0.3, 0.0])  # s: both see an empty list, and the first to list its code is the last to write it
    monkeypatch.setattr(IndexDataCacheFile, "_load_index", lambda file: (load(file), time.sleep(0.2))[0])
    monkeypatch.setattr(IndexDataCacheFile, "_save_data", lambda *words: (time.sleep(next(waits)), save(*words)))
    caches = [jit.serial_kernel(twice)._cache for _ in range(2)]  # pyright: ignore[reportFunctionMemberAccess]
    threads = [
        threading.Thread(target=cache.save_overload, args=each)
        for cache, each in zip(caches, kernel.overloads.items(), strict=True)
    ]
    for thread in threads:
        thread.start()
        time.sleep(0.1)
    for thread in threads:
        thread.join()
    fresh: Any = jit.serial_kernel(twice)
    assert (fresh(0.5), fresh(2), sum(fresh.stats.cache_hits.values())) == (1.0, 4, 2)
    assert fresh.signatures == kernel.signatures


def test_code_of_sources_that_nobody_ran_for_long_is_removed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv("VISCOPOINT_CACHE", str(tmp_path))
    old, recent, other = tmp_path / f"kernels-{16 * 'a'}", tmp_path / f"kernels-{16 * 'b'}", tmp_path / "kernels-mine"
    for folder in (old, recent, other):
        folder.mkdir()
        (folder / "code").touch()
    for folder in (old, other):
        os.utime(folder, (0.0, time.time() - 1.1 * kernel_cache.UNUSED))
    used = kernel_cache.cache_folder.__wrapped__()
    assert used.parent == tmp_path
    assert sorted(tmp_path.iterdir()) == sorted([recent, other, used])
