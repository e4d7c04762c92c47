import gc
import os
import signal
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numba
import pytest

import viscopoint as vp
from viscopoint.reproduction import Reproduction, reproduce

MADE = ["tests/validation/test_reproduction.py", "tests/browser/test_report_page.py"]  # they need the fixture
OWN_CACHES = ["tests/unit/test_outside.py", "tests/unit/test_kernels.py", "tests/unit/test_kernel_cache.py"]
SMALL = {
    "method.cell": "1 mm",
    "method.spacing": "0.72 mm",
    "time.end": "2 us",
    "time.snapshots": ["1 us"],
}
SMALL_FEM = {"method.size": "1.2 mm", "time.end": "2 us", "time.snapshots": ["1 us"]}


def pytest_configure() -> None:
    """Let processes that tests start hear Ctrl-C, also if the tests go on in the background of a shell.

    And let them keep the package's bytecode, of which each would else make its own: a sixth of the time of their start.
    """
    signal.signal(signal.SIGINT, signal.default_int_handler)
    os.environ.pop("PYTHONDONTWRITEBYTECODE", None)


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> Any:
    """Let each file be worked on by one process, as its tests share runs and kernels, and so the files of ``made``."""
    from xdist.scheduler import LoadFileScheduling

    class Scheduling(LoadFileScheduling):
        def _split_scope(self, nodeid: str) -> str:
            file = super()._split_scope(nodeid)
            return MADE[0] if file in MADE else file

    config.option.loadscopereorder = False
    return Scheduling(config, log)


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Let processes begin with what takes longest, and with what compiles into caches of its own.

    A kernel that two processes lack at the same time is compiled by both.
    """
    if is_one_of_several(config):
        first = [*MADE, *OWN_CACHES]
        files = {item: item.nodeid.partition("::")[0] for item in items}
        items.sort(key=lambda item: first.index(files[item]) if files[item] in first else len(first))


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
