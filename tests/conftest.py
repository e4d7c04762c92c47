import gc
import signal
from pathlib import Path

import pytest

import viscopoint as vp
from viscopoint.reproduction import Reproduction, reproduce

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


def pytest_collection_finish() -> None:
    """Look for garbage less often, as the command line does: while kernels compile that takes a tenth of the time."""
    gc.freeze()
    gc.set_threshold(100_000, 20, 50)


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
