import contextlib
import json
import os
import shutil
import signal
import subprocess
import sys
import time
import tomllib
from pathlib import Path
from typing import Any

import pytest
from shell import call

import viscopoint as vp
from viscopoint.case.case import Case
from viscopoint.methods.fem.inputs import FEMInput
from viscopoint.methods.mpm.inputs import MPMInput
from viscopoint.methods.tlmpm.inputs import TotalLagrangianInput

QUICK = [
    "--set",
    "method.cell=1 mm",
    "--set",
    "method.spacing=0.72 mm",
    "--set",
    "time.end=1 us",
    "--set",
    "time.snapshots=[]",
]


def test_run_leaves_a_whole_run_folder_and_show_prints_it(tmp_path: Path):
    folder = tmp_path / "deep" / "run"
    code, out, messages = call("run", "paper", "--out", folder, *QUICK)
    assert (code, messages) == (0, "")
    assert "complete" in out
    names = {str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file()}
    figures = {f"figures/{name}.png" for name in ("shapes", "profiles", "histories", "energies")}
    fields = {"fields.vtkhdf.series", "fields/fields_00000.vtkhdf", "fields/fields_00001.vtkhdf"}
    own = {"case.toml", "provenance.json", "summary.json", "history.csv", ".lock"}
    assert names == own | fields | figures
    code, shown, _ = call("show", folder)
    assert code == 0
    assert shown == out


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["run", "papr"], "did you mean 'paper'"),
        (["run", "absent.toml"], "cannot be read"),
        (["run", "paper", "--set", "rod.radius=4"], "rod.radius: 4 is a bare number"),
        (["run", "paper", "--set", "rod.raduis=4 mm"], "did you mean 'radius'"),
        (["run", "paper", "--set", "rod.radius"], "KEY=VALUE"),
        (["run", "paper", "--set", "=3"], "KEY=VALUE"),
        (["run", "paper", "--set", "impact.friction=nan"], "must be finite"),
        (["run", "paper", "--set", 'time.snapshots=["30 us"]'], "after time.end"),
        (["run", "x" * 300], "there is no case"),
        (["run", "paper", "--set", "material.bulk=10 TPa", "--set", "time.end=10 s"], "steps; check"),
        (["run", "paper", "--set", "material.bulk=550 mPa"], "has no known unit ('mPa'); did you mean 'MPa'?"),
        (["run", "paper", "--set", "material.density=1 ton/m^3"], "write 'tonne' (1000 kg), 'short_ton' (2000 lb)"),
        (["run", "paper", "--set", "impact.speed=150 km/s"], 'did you mean "150 m/s"?'),
        (["run", "paper", "--threads", "1000"], "this machine has"),
        (["reproduce", "--only", "fig9"], "figure 'fig9' is not known; did you mean"),
        (["reproduce", "--resolution", "finest"], "resolution 'finest' is not known; did you mean 'fine'"),
        (["compare", "absent", "missing"], "run folder absent: there is no such folder"),
    ],
)
def test_bad_input_gives_one_message_and_code_2_and_writes_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, words: list[str], message: str
):
    monkeypatch.chdir(tmp_path)
    code, out, messages = call(*words)
    assert code == 2
    assert out == ""
    assert message in messages
    assert "Traceback" not in messages
    assert list(tmp_path.iterdir()) == []


def test_an_existing_folder_is_kept_without_force(tmp_path: Path):
    folder = tmp_path / "run"
    assert call("run", "paper", "--out", folder, "--no-figures", *QUICK)[0] == 0
    before = {path: path.stat().st_mtime_ns for path in folder.rglob("*")}
    code, _, messages = call("run", "paper", "--out", folder, *QUICK)
    assert code == 2
    assert "already there" in messages
    assert {path: path.stat().st_mtime_ns for path in folder.rglob("*")} == before
    assert call("run", "paper", "--out", folder, "--force", "--no-figures", *QUICK)[0] == 0


def test_a_reproduction_goes_into_its_own_folder_alone(tmp_path: Path):
    (tmp_path / "thesis.txt").write_text("all my work")
    code, _, messages = call("reproduce", "--out", tmp_path)
    assert code == 2
    assert "has no reproduction.json" in messages
    assert [path.name for path in tmp_path.iterdir()] == ["thesis.txt"]
    code, _, messages = call("reproduce", "--out", tmp_path / "thesis.txt" / "deep")
    assert (code, "cannot be made" in messages) == (2, True)


def test_force_never_removes_what_is_no_run(tmp_path: Path):
    precious = tmp_path / "precious"
    precious.mkdir()
    (precious / "thesis.txt").write_text("all my work")
    code, _, messages = call("run", "paper", "--out", precious, "--force", *QUICK)
    assert code == 2
    assert "has no provenance.json" in messages
    assert (precious / "thesis.txt").read_text() == "all my work"


def test_a_folder_that_cannot_be_written_is_refused():
    # /proc is a folder that even root cannot write
    code, _, messages = call("run", "paper", "--out", "/proc/self/run", *QUICK)
    assert code == 2
    assert "cannot be made" in messages


def test_a_file_where_the_folder_should_be_is_refused(tmp_path: Path):
    (tmp_path / "file").write_text("")
    assert call("run", "paper", "--out", tmp_path / "file", *QUICK)[0] == 2
    assert call("run", "paper", "--out", tmp_path / "file" / "run", *QUICK)[0] == 2


def test_a_guard_ends_with_code_1_and_keeps_what_was_computed(tmp_path: Path):
    folder = tmp_path / "run"
    code, out, _ = call("run", "paper", "--out", folder, *QUICK, "--set", "guards.energy_error=1e-6")
    assert code == 1
    assert "INCOMPLETE" in out
    assert "energy balance does not close" in " ".join(out.split())
    summary = json.loads((folder / "summary.json").read_text())
    assert summary["status"] == "stopped"
    assert summary["snapshots"][0]["time"] == 0.0
    assert (folder / "figures" / "shapes.png").is_file()


@pytest.mark.parametrize("name", ["summary.json", "provenance.json"])
@pytest.mark.parametrize(
    "text", ["[1, 2", "[1, 2]", "{}", '{"status": "done"}', '{"status": "complete", "snapshots": 3}']
)
def test_show_refuses_a_folder_that_is_not_a_run(tmp_path: Path, finished: Path, name: str, text: str):
    assert call("show", tmp_path)[0] == 2
    copy = tmp_path / "copy"
    copy.mkdir()
    for path in finished.iterdir():
        if path.is_file():
            (copy / path.name).write_bytes(path.read_bytes())
    (copy / name).write_text(text)
    code, _, messages = call("show", copy)
    assert code == 2
    assert name in messages or "format" in messages
    assert "Traceback" not in messages


def test_cases_new_and_schema(tmp_path: Path):
    assert {line.split()[0] for line in call("cases")[1].splitlines() if line[0] != " "} == {
        "copper", "copper-fem", "paper", "paper-6.5", "paper-65", "paper-elastic",
    }  # fmt: skip
    assert json.loads(call("schema")[1])["title"] == "Case"
    file = tmp_path / "mine.toml"
    assert call("new", file)[0] == 0
    assert call("new", file)[0] == 2
    assert call("new", tmp_path / "absent" / "mine.toml")[0] == 2
    quick = ("--set", "method.spacing=0.9 mm", "--set", "time.end=1 us", "--set", "time.snapshots=[]")
    assert call("run", file, "--out", tmp_path / "run", "--no-figures", *quick)[0] == 0


def uncommented(lines: list[str], besides: str) -> str:
    """Return the lines with keys that were commented out, but for one that shows no default."""
    return "\n".join(line[2:] if line.startswith("# ") and not line.startswith(besides) else line for line in lines)


def test_starter_case_shows_the_true_defaults(tmp_path: Path):
    file = tmp_path / "mine.toml"
    call("new", file)
    shown = uncommented(file.read_text().splitlines()[4:], besides="# law")
    assert "\nenergy_error" in shown
    assert Case.from_tables(tomllib.loads(shown)) == Case.load(file).resolved()


@pytest.mark.parametrize(("mark", "besides", "kept", "table", "left"), [
    ("## ", "# mesh =", {"name": "fem", "size": "0.38 mm"}, FEMInput, {"mesh"}),
    ("### ", "# #", {"name": "mpm", "spacing": "0.38 mm", "cell": "0.76 mm"}, MPMInput, set()),
])  # fmt: skip
def test_starter_case_shows_the_other_methods_as_alternatives(
    tmp_path: Path, mark: str, besides: str, kept: dict[str, str], table: Any, left: set[str]
):
    file = tmp_path / "mine.toml"
    call("new", file)
    lines = [line.removeprefix(mark) for line in file.read_text().splitlines() if line.startswith(mark)]
    shown, least = (tomllib.loads(text) for text in (uncommented(lines, besides), "\n".join(lines)))
    case = Case.load(file).to_tables()
    assert Case.from_tables(case | shown).resolved() == Case.from_tables(case | least).resolved()
    assert least["method"] == kept
    assert set(shown["method"]) | left == set(table.model_fields)


def test_starter_case_takes_the_recommended_method_as_any_case_that_names_none(tmp_path: Path):
    file = tmp_path / "mine.toml"
    call("new", file)
    case = Case.load(file)
    assert isinstance(case.method, TotalLagrangianInput)
    assert case.method.spacing == pytest.approx(case.rod.radius / 10)
    assert case.method.cell == 2 * case.method.spacing
    tables = tomllib.loads(file.read_text())
    del tables["method"]
    assert Case.from_tables(tables) == Case.from_tables(tables | {"method": {}}) == case
    coarse = Case.from_tables(tables | {"method": {"spacing": "0.5 mm"}}).method
    assert isinstance(coarse, TotalLagrangianInput)
    assert (coarse.spacing, coarse.cell) == (0.5, 1.0)


def test_ctrl_c_ends_with_code_130_and_keeps_what_was_computed(tmp_path: Path):
    folder = tmp_path / "run"
    endless = (
        "time.end=20 ms",
        "time.snapshots=[]",
        "output.history={every = 1}",
        "method.box.z=['-0.01 mm', '9 m']",
    )
    settings = [word for setting in endless for word in ("--set", setting)]
    command = [sys.executable, "-m", "viscopoint", "run", "paper", "--out", str(folder), "--no-figures", *settings]
    # a shell that runs tests in the background makes them ignore SIGINT; a user's does not
    process = subprocess.Popen(
        command, stdout=subprocess.DEVNULL, preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL)
    )
    history = folder / "history.csv"
    deadline = time.monotonic() + 120
    while time.monotonic() < deadline and not (history.exists() and history.stat().st_size > 8_000):
        time.sleep(0.05)
    process.send_signal(signal.SIGINT)
    assert process.wait(timeout=60) == 130
    summary = json.loads((folder / "summary.json").read_text())
    assert summary["status"] == "interrupted"
    written = len(history.read_text().splitlines()) - 2  # without the header and the start
    assert written in (summary["steps"] - 1, summary["steps"])  # Ctrl-C may come between a step and its row


def process(*words: str | Path, **settings: Any) -> subprocess.CompletedProcess[str]:
    """Run the command line in a process of its own."""
    line = [sys.executable, "-m", "viscopoint", *map(str, words)]
    return subprocess.run(line, stderr=subprocess.PIPE, text=True, check=False, **settings)


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no /dev/full")
@pytest.mark.parametrize("words", [("show",), ("schema",)])
def test_words_that_cannot_be_written_give_code_3(finished: Path, words: tuple[str, ...]):
    with Path("/dev/full").open("w") as full:
        done = process(*words, *([finished] if words == ("show",) else []), stdout=full)
    assert (done.returncode, done.stderr) == (3, "viscopoint: [Errno 28] No space left on device\n")


COARSE = [*QUICK[4:], "--set", "method.size=1.9 mm", "--method", "fem", "--no-figures"]
STOPPED = ["--set", "guards.energy_error=1e-9"]


def shell(line: str, *words: str | Path) -> tuple[int, str, str]:
    """Run a line of bash, in which $V is the command line and "$@" are words; return its code, output and messages."""
    command = ["bash", "-c", f"set -o pipefail; {line}", "bash", *map(str, words)]
    done = subprocess.run(
        command, capture_output=True, text=True, check=False, env=os.environ | {"V": f"{sys.executable} -m viscopoint"}
    )
    return done.returncode, done.stdout, done.stderr


@pytest.mark.parametrize("closed", [">&- 2>&- <&-", "| head -1", "2>&1 | true"])
@pytest.mark.parametrize(("settings", "code"), [([], 0), (STOPPED, 1)])
def test_a_run_ends_with_its_own_code_whoever_reads(tmp_path: Path, closed: str, settings: list[str], code: int):
    line = f'$V run paper --out "$@" {closed}'
    found, out, messages = shell(line, tmp_path / "run", *COARSE, *settings)
    assert (found, messages) == (code, "")
    assert len(out.splitlines()) == (closed == "| head -1")
    run = vp.Run(tmp_path / "run")
    assert run.status == ("complete" if code == 0 else "stopped")
    assert run.history["time"].iloc[-1] == run.rows[-1].time  # nothing was printed into the files


@pytest.mark.parametrize("closed", [">&-", "2>&-", "2>&1 | true"])
@pytest.mark.parametrize(
    ("words", "code"), [(["show"], 0), (["schema"], 0), (["cases"], 0), (["run", "papr"], 2), (["verify"], 1)]
)
def test_output_that_nobody_reads_changes_no_code(
    tmp_path: Path, finished_fem: Path, closed: str, words: list[str], code: int
):
    other = tmp_path / "other"
    if words == ["verify"]:  # with another result than the run had
        shutil.copytree(finished_fem, other)
        text = (other / "case.toml").read_text()
        (other / "case.toml").write_text(text.replace("650.0 1/ms", "65.0 1/ms"))
    folder = {"show": [finished_fem], "verify": [other]}.get(words[0], [])
    found, _, messages = shell(f'$V "$@" {closed}', *words, *folder)
    assert found == code
    assert "Traceback" not in messages
    assert "Exception" not in messages


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no /dev/full")
def test_a_table_that_cannot_be_written_gives_code_3_and_keeps_the_run(tmp_path: Path):
    code, _, messages = shell('$V run paper --out "$@" >/dev/full', tmp_path / "run", *COARSE)
    assert (code, messages) == (3, "viscopoint: [Errno 28] No space left on device\n")
    assert vp.Run(tmp_path / "run").status == "complete"


def test_a_terminal_of_few_characters_shows_the_others_as_escapes(finished: Path, tmp_path: Path):
    folder = shutil.copytree(finished, tmp_path / "run")
    text = vp.Case.load(folder / "case.toml", {"title": "\u03b2 rod"}).to_toml()
    (folder / "case.toml").write_text(text, encoding="utf-8")
    done = process("show", folder, stdout=subprocess.PIPE, env=os.environ | {"PYTHONIOENCODING": "ascii"})
    assert (done.returncode, done.stderr) == (0, "")
    assert "\\u03b2 rod" in done.stdout


def test_a_folder_whose_name_is_no_text_is_as_good_as_any(tmp_path: Path):
    words = [sys.executable, "-m", "viscopoint", "run", "paper", *QUICK, "--no-figures", "--out"]
    done = subprocess.run([*map(os.fsencode, words), os.fsencode(tmp_path) + b"/h\xff"], capture_output=True)
    assert (done.returncode, done.stderr) == (0, b"")


def test_the_folder_one_is_in_is_not_replaced(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.chdir(tmp_path)
    code, _, messages = call("run", "paper", "--out", ".", *QUICK)
    assert (code, "the one you are in" in messages) == (2, True)
    assert not list(tmp_path.iterdir())


def test_memory_that_runs_out_anywhere_gives_code_3(monkeypatch: pytest.MonkeyPatch):
    def scarce() -> None:
        raise MemoryError("Unable to allocate 9 GiB")

    monkeypatch.setattr("viscopoint.case.case.packaged", scarce)
    code, _, messages = call("cases")
    assert (code, messages) == (3, "viscopoint: memory ran out (Unable to allocate 9 GiB)\n")


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_verification_that_is_interrupted_accuses_nobody(finished: Path, number: signal.Signals):
    code = (
        "import os, signal\n"
        "from viscopoint.command_line import cli\n"
        "from viscopoint.model import simulation\n"
        "Simulation = simulation.Simulation\n"
        "advance = Simulation._advance_towards\n"
        f"Simulation._advance_towards = lambda *words: (os.kill(os.getpid(), {number.value}), advance(*words))[1]\n"
        f"cli.app(['verify', {str(finished)!r}])\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert (done.returncode, done.stdout, done.stderr) == (128 + number, "", "viscopoint: interrupted\n")


def test_the_cursor_comes_back_when_a_run_is_ended_at_once(tmp_path: Path):
    pty = pytest.importorskip("pty")
    line = [sys.executable, "-m", "viscopoint", "run", "paper", "--out", str(tmp_path / "run"), "--no-figures"]
    child, terminal = pty.fork()
    if child == 0:
        os.execv(sys.executable, line)
    shown = b""
    with contextlib.suppress(OSError):  # at the end
        while piece := os.read(terminal, 4096):
            shown += piece
            if b"\x1b[?25l" in shown and b"reading" in shown:
                os.kill(child, signal.SIGINT)  # until it is heard
                time.sleep(0.05)
    os.waitpid(child, 0)
    assert shown.rindex(b"\x1b[?25h") > shown.rindex(b"\x1b[?25l")
    assert b"interrupted" in shown
