"""Run folders from others: what ``show`` and ``compare`` read, but for the fields."""

import contextlib
import io
import os
import shutil
from pathlib import Path

from choices import Choices, chance, one_of
from edits import edited

from viscopoint.command_line.terminal import print_summary
from viscopoint.comparison import Comparison, differing
from viscopoint.results.folder import CASE, PROVENANCE, SUMMARY
from viscopoint.results.output.history import NAME as HISTORY
from viscopoint.results.run import Run

MODULES = (
    "json.decoder", "viscopoint.errors", "viscopoint.messages", "viscopoint.results.safe_read", "viscopoint.case.case",
    "viscopoint.results.summary", "viscopoint.results.reader", "viscopoint.comparison",
    "viscopoint.command_line.terminal",
)  # fmt: skip
NAMES = (PROVENANCE, SUMMARY, CASE, HISTORY)
PIECES = (
    b'"mesh": 3,', b'{"reason": "\\u001b[2J", ', b'"sources": [1], ', b'"resumed": 5, ', b'"snapshots": [{}], ',
    b'"status": ', b'[method]\nname = "fem"\nmesh = "../outside/canary.toml"\n', b'mesh = "mesh.vtu"\n',
    b'mesh = "/dev/zero"\n', b'"initial_kinetic_energy [mJ]": 1e-320,', b'"steps": 99999999999999999999,', b"1,2,3\n",
    b"nan," * 24 + b"nan\n", b"\n" * 9,
)  # fmt: skip


class Target:
    """A finished run, of which files are damaged or replaced by what is none."""

    def __init__(self, folder: Path, seeds: Path | None) -> None:
        assert seeds is not None, "give a finished run by --seeds"
        self.folder, self.sound = folder / "run", Run(seeds)
        self.folder.mkdir()
        self.whole = {name: (seeds / name).read_bytes() for name in NAMES}
        (self.folder / "mesh.vtu").write_bytes(b"no mesh")
        for name, content in self.whole.items():
            (self.folder / name).write_bytes(content)
        self.check()  # what is imported only when needed

    def lay(self, choices: Choices) -> str:
        told = []
        changed = {one_of(choices, NAMES) for _ in range(choices.integer(1, 2))}
        for name, content in self.whole.items():
            path = self.folder / name
            _remove(path)
            if name in changed and chance(choices, 10):
                told.append(f"{name}: {_replace(choices, path)}")
                continue
            path.write_bytes(edited(choices, content, PIECES) if name in changed else content)
            if name in changed:
                told.append(f"{name}: {path.read_bytes()!r:.3000}")
        return "; ".join(told)

    def check(self) -> None:
        run = Run(self.folder)
        repr(run)
        with contextlib.redirect_stdout(io.StringIO()) as screen:
            print_summary(run)
        assert "\x1b" not in screen.getvalue()
        assert run.columns
        assert len(run.history)
        Comparison((self.sound, run), ("one", "other"), (), (), ()).warnings()
        differing(self.sound, run)


def _remove(path: Path) -> None:
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path)
    else:
        path.unlink(missing_ok=True)


def _replace(choices: Choices, path: Path) -> str:
    """Put something else where a file should be; say what."""
    kind = one_of(choices, ("pipe", "folder", "nothing", "hole", "link", "circle", "device", "twin"))
    if kind == "pipe":
        os.mkfifo(path)
    elif kind == "folder":
        path.mkdir()
    elif kind == "hole":
        with path.open("wb") as file:
            file.truncate(2**40)
    elif kind in ("link", "circle", "device", "twin"):
        there = {"link": "../../outside/canary.toml", "circle": path.name, "device": "/dev/zero", "twin": SUMMARY}
        path.symlink_to(there[kind])
    return kind
