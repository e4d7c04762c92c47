"""What kernels work with: blocks of points, slabs shared out, a logarithm; and that a step takes no memory."""

import math
import tracemalloc
from itertools import chain
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from viscopoint.case.case import Case
from viscopoint.kernels.arrays import Array
from viscopoint.kernels.jit import PARTS, serial_kernel
from viscopoint.kernels.logarithm import log
from viscopoint.kernels.slabs import COLOURS, coloured_slabs_of, slabs_of
from viscopoint.kernels.values import pick
from viscopoint.kernels.workspace import BLOCK, HISTORY, columns, load, load_tuple, store, workspace
from viscopoint.model.build import build

ROUNDING = np.finfo(float).eps
FIRST, SECOND, THIRD, _ = columns(1, 3, 1)


@serial_kernel
def logarithms(x: Array, found: Array) -> None:
    for n in range(len(x)):
        found[n] = log(x[n])


def test_logarithm_is_that_of_the_library() -> None:
    rng = np.random.default_rng(1)
    near_one = 1.0 + 10.0 ** rng.uniform(-16, -1, 5000) * rng.choice([-1, 1], 5000)  # where J is
    x = np.concatenate([near_one, np.exp(rng.uniform(-700, 700, 5000)), [1.0, 0.5, 2.0, math.sqrt(0.5)]])
    found = np.empty_like(x)
    logarithms(x, found)
    assert_allclose(found, np.log(x), rtol=3 * ROUNDING, atol=0)
    logarithms(np.array([0.0, -1.0, np.nan]), found)
    assert np.isnan(found[:3]).all()


@serial_kernel
def there_and_back(rows: Array, histories: Array, blank: Any) -> None:
    work = workspace(len(blank))  # pyright: ignore[reportCallIssue]  (an intrinsic)
    for i in range(len(rows)):
        store(work, FIRST, i, rows[i, 0])
        store(work, SECOND, i, (rows[i, 1], rows[i, 2], rows[i, 3]))
        store(work, THIRD, i, rows[i, 4])
        store(work, HISTORY, i, (histories[i, 0], histories[i, 1]))
    for i in range(len(rows)):
        rows[i, 0] = load(work, FIRST, i)
        x, y, z = load_tuple(work, SECOND, i, (0.0, 0.0, 0.0))
        rows[i, 1], rows[i, 2], rows[i, 3], rows[i, 4] = x, y, z, load(work, THIRD, i)
        histories[i, 0], histories[i, 1] = load_tuple(work, HISTORY, i, blank)


def test_quantities_of_a_block_do_not_share_memory() -> None:
    rows, histories = (
        np.random.default_rng(2).normal(size=(BLOCK, 7))[:, :5],
        np.random.default_rng(3).normal(size=(BLOCK, 2)),
    )
    found, later = rows.copy(), histories.copy()
    there_and_back(found, later, (0.0, 0.0))
    assert_array_equal(found, rows)
    assert_array_equal(later, histories)


@serial_kernel
def picked(values: Any, found: Array) -> None:
    for n in range(len(found)):
        found[n] = pick(values, n)


@pytest.mark.parametrize("values", [(3.0,), (1.0, 2.0), (1.0, 2.0, 4.0, 8.0)])
def test_pick_takes_each_of_a_tuple(values: tuple[float, ...]) -> None:
    found = np.empty(len(values))
    picked(values, found)
    assert_array_equal(found, values)


@pytest.mark.parametrize("counts", [[5], [0, 0, 7, 0], [0] * 4, [3] * 100, [1000, *[1] * 60], [0, 9, *[4] * 30, 0, 0]])
def test_parts_take_every_slab_once_and_about_as_many_points(counts: list[int]) -> None:
    start, slabs = np.concatenate([[0], np.cumsum(counts)]), len(counts)
    taken = [list(slabs_of(start, slabs, part)) for part in range(PARTS)]
    assert list(chain(*taken)) == list(range(slabs))
    by_colour = [list(coloured_slabs_of(start, slabs, part)) for part in range(COLOURS * PARTS)]
    assert sorted(chain(*by_colour)) == list(range(slabs))
    for number, some in enumerate(by_colour):  # all parts of a colour follow one another
        assert all(slab % COLOURS == number // PARTS for slab in some)
    points = [sum(counts[slab] for slab in slabs_) for slabs_ in taken]
    assert max(points) <= sum(counts) / PARTS + max(counts)


STEPS: list[tuple[str, dict[str, Any]]] = [
    ("mpm", {}),
    ("tlmpm", {}),
    ("fem", {}),
]
COSTLY = ("mpm", {"method.volume": "cell-mean", "method.contact": "gated", "method.transfer": "apic"})


@pytest.mark.parametrize(
    ("name", "changes"),
    [*STEPS, pytest.param(*COSTLY, marks=pytest.mark.long)],
    ids=lambda value: "-".join(value.values()) if value and isinstance(value, dict) else "",
)
def test_a_step_takes_no_memory_that_grows_with_the_body(name: str, changes: dict[str, Any]) -> None:
    size = "method.size" if name == "fem" else "method.spacing"
    taken = [memory_of_steps(name, {**changes, size: f"{h} mm"}) for h in (0.5, 0.3)]
    (few, little), (many, much) = taken
    assert many > 3 * few
    assert much - little < 0.2 * (many - few)  # bytes; the least array would take one of each point


def memory_of_steps(name: str, changes: dict[str, Any]) -> tuple[int, int]:
    """Return how many points a body has, and how many bytes Python and NumPy ask for at most at once in steps."""
    method = build(Case.load("paper", changes, method=name)).method
    for _ in range(3):  # kernels are loaded, the grid's window has its size
        method.advance(0.2 * method.stable_step())
    tracemalloc.start()
    before, _ = tracemalloc.get_traced_memory()
    for _ in range(3):
        method.advance(0.2 * method.stable_step())
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    return len(method.positions()), peak - before
