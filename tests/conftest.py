import gc
import signal
from collections.abc import Iterator
from pathlib import Path

import numba
import pytest

import viscopoint as vp
from viscopoint.reproduction import Reproduction, reproduce

FIRST = ("made", "test_outside.py", "test_kernels.py", "test_kernel_cache.py")
SMALL = {
    "method.cell": "1 mm",
    "method.spacing": "0.72 mm",
    "time.end": "2 us",
    "time.snapshots": ["1 us"],
}
SMALL_FEM = {"method.size": "1.2 mm", "time.end": "2 us", "time.snapshots": ["1 us"]}


def pytest_configure() -> None:
    """Let processes that tests start hear Ctrl-C, also if the tests go on in the background of a shell."""
    signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Let each file be worked on by one process, as its tests share runs and kernels, and so all that need ``made``.

    First come ``made``, which takes longest, and what compiles the same kernels again: what two processes lack at the
    same time, both compile.
    """
    if is_one_of_several(config):
        groups = {item: "made" if "made" in getattr(item, "fixturenames", ()) else item.path.name for item in items}
        for item, group in groups.items():
            item.add_marker(pytest.mark.xdist_group(group))
        items.sort(key=lambda item: FIRST.index(groups[item]) if groups[item] in FIRST else len(FIRST))


def is_one_of_several(config: pytest.Config) -> bool:
    """Return whether pytest-xdist lets other processes test beside this one."""
    return hasattr(config, "workerinput")


def pytest_collection_finish(session: pytest.Session) -> None:
    """Look for garbage less often, as the command line does: while kernels compile that takes a tenth of the time.

    Of several processes that test at the same time each computes on one thread; tests of threads ask for more.
    """
    gc.freeze()
    gc.set_threshold(100_000, 20, 50)
    if is_one_of_several(session.config):
        numba.set_num_threads(1)


@pytest.fixture(autouse=True)
def _as_many_threads_as_before() -> Iterator[None]:
    before = numba.get_num_threads()
    yield
    numba.set_num_threads(before)


@pytest.fixture
def quick() -> vp.Case:
    """A small rod that hits the wall in a few steps: for tests of everything around the physics."""
    return vp.Case.load("paper", SMALL)


@pytest.fixture(scope="session")
def finished(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The run folder of the quick case."""
    folder = tmp_path_factory.mktemp("runs") / "quick"
    vp.run(vp.Case.load("paper", SMALL), folder)
    return folder


@pytest.fixture(scope="session")
def finished_fem(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The run folder of a small rod of finite elements."""
    folder = tmp_path_factory.mktemp("runs") / "quick-fem"
    vp.run(vp.Case.load("paper", SMALL_FEM, method="fem"), folder, figures=False)
    return folder


@pytest.fixture(scope="session")
def made(tmp_path_factory: pytest.TempPathFactory) -> Reproduction:
    """The paper reproduced at its own resolution."""
    return reproduce(tmp_path_factory.mktemp("reproduction") / "made")
