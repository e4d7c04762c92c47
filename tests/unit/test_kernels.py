import ast
import os
import shutil
import subprocess
import sys
from pathlib import Path

import viscopoint

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
    # Numba drops such stores inside prange (see viscopoint.jit.kernel)
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


def run_python(code: str, package: Path, cache: Path) -> str:
    """Run code in a new process on a copy of the package, with its own cache folder."""
    environment = os.environ | {"PYTHONPATH": str(package.parent), "XDG_CACHE_HOME": str(cache)}
    done = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True)
    return done.stdout


LAW_IN_KERNEL = """
import numpy as np
from viscopoint.jit import serial_kernel
from viscopoint.laws.elastic import Elastic
from viscopoint.mpm.stress import sum_points
from viscopoint.mpm.points import at_rest
points = at_rest(np.zeros((1, 3)), np.ones(1), np.ones(1), 0)
points.jacobian[:] = 0.9
sums = np.zeros((64, 8))
sum_points(points, Elastic(1e-3, 100.0, 10.0), (), sums)
print(sums[:, 1].sum(), sum(sum_points.stats.cache_hits.values()))
"""


def test_an_edited_law_is_never_run_stale_and_a_warm_start_compiles_nothing(tmp_path: Path):
    copy = tmp_path / "copy" / "viscopoint"
    shutil.copytree(PACKAGE, copy, ignore=shutil.ignore_patterns("__pycache__"))
    cold, hits = run_python(LAW_IN_KERNEL, copy, tmp_path / "cache").split()
    assert hits == "0"
    warm, hits = run_python(LAW_IN_KERNEL, copy, tmp_path / "cache").split()
    assert (warm, hits) == (cold, "1")
    law = copy / "laws" / "__init__.py"
    law.write_text(law.read_text().replace("return bulk * (", "return 2.0 * bulk * ("))
    edited, _ = run_python(LAW_IN_KERNEL, copy, tmp_path / "cache").split()
    assert float(edited) == 2.0 * float(cold)
