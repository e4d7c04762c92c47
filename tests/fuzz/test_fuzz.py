"""Any bytes where a case, a mesh or a run folder should be are taken, or refused with a message, and do no harm.

A few hundred inputs of each kind by default; 20,000 in the long tests, as do their 20,000 by atheris, where it is
installed (`pip install 'viscopoint[fuzz]'`): it follows which code the inputs reach.
"""

import importlib.util
import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

HARNESS = Path(__file__).with_name("harness.py")
TARGETS = sorted(file.stem for file in (HARNESS.parent / "targets").glob("*.py"))
FEW = {"cases": 200, "meshes": 80, "run_folders": 150, "checkpoints": 80, "fields": 120}  # what takes some seconds
MANY = 20_000
FAILURES = ("tracebacks", "hangs", "escapes", "messages")


def fuzzed(target: str, inputs: int, seeds: Path, folder: Path, engine: str) -> dict[str, Any]:
    """Run the harness; return what it found."""
    command = [sys.executable, HARNESS, target, folder, "--inputs", str(inputs), "--seeds", seeds, "--engine", engine]
    ended = subprocess.run(command, capture_output=True, text=True, errors="replace", check=False)
    result = folder / "result.json"
    assert result.exists(), ended.stderr[-5000:]
    return json.loads(result.read_text())


def assert_harmless(found: dict[str, Any], inputs: int) -> None:
    assert not found["defects"], json.dumps(found["defects"], indent=1)[:10_000]
    assert {kind: found[kind] for kind in FAILURES} == dict.fromkeys(FAILURES, 0)
    assert found["inputs"] >= inputs
    assert found["taken"] > 0  # or nothing but the first check would be tried
    assert found["refused"] > 0


@pytest.mark.parametrize("target", TARGETS)
def test_a_few_inputs_of_any_kind_do_no_harm(target: str, finished: Path, tmp_path: Path):
    few = FEW.get(target, 200)
    assert_harmless(fuzzed(target, few, finished, tmp_path / "fuzz", "hypothesis"), few)


@pytest.mark.long
@pytest.mark.parametrize("engine", ["hypothesis", "atheris"])
@pytest.mark.parametrize("target", TARGETS)
def test_many_inputs_of_any_kind_do_no_harm(target: str, engine: str, finished: Path, tmp_path: Path):
    if engine == "atheris" and importlib.util.find_spec("atheris") is None:
        pytest.skip("atheris is not installed")
    assert_harmless(fuzzed(target, MANY, finished, tmp_path / "fuzz", engine), MANY)


@pytest.mark.parametrize(
    ("attack", "kind"),
    [
        ("raise ZeroDivisionError", "tracebacks"),
        ("time.sleep(30)", "hangs"),
        ("open(folder.parent / 'elsewhere', 'w')", "escapes"),
        ("(folder / '../outside/canary.txt').unlink()", "escapes"),
        ("os.system('true')", "escapes"),
        ("pickle.loads(pickle.dumps(Path))", "escapes"),
        ("raise vp.InputError('')", "messages"),
        ("object.__new__(Noisy)", "tracebacks"),
    ],
)
def test_the_watch_sees_what_goes_wrong(attack: str, kind: str, tmp_path: Path):
    program = tmp_path / "attack.py"
    program.write_text(
        "import json, os, pickle, sys, time\n"
        "from pathlib import Path\n"
        "import viscopoint as vp\n"
        "import watch\n"
        "watch.HANG = 0.5\n"
        f"folder = Path({str(tmp_path)!r}) / 'inside'\n"
        "folder.mkdir()\n"
        "class Noisy:\n    def __del__(self): raise ValueError\n"
        "watching = watch.Watch(folder)\n"
        f"def attack(): {attack}\n"
        "watching.run(attack, 'it')\n"
        "print(json.dumps([watching.counts, [entry['input'] for entry in watching.defects.values()]]))\n"
    )
    (tmp_path / "outside").mkdir()
    (tmp_path / "outside" / "canary.txt").touch()
    environment = {"PYTHONPATH": str(HARNESS.parent), "PATH": "", "HOME": str(tmp_path)}
    ended = subprocess.run([sys.executable, program], capture_output=True, text=True, env=environment, check=True)
    counts, inputs = json.loads(ended.stdout)
    assert counts[kind] == 1, counts
    assert inputs == ["it"]
    assert (tmp_path / "outside" / "canary.txt").exists()
