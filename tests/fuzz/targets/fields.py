"""Fields of a run folder from others: what HDF5 reads, and the journal of a snapshot that was being appended."""

import shutil
from pathlib import Path

from choices import Choices, chance
from edits import edited

from viscopoint.output.fields import NAME
from viscopoint.results import Run

MODULES = ("viscopoint.errors", "viscopoint.output.fields", "viscopoint.transaction", "viscopoint.results")
JOURNAL = f".{NAME}.journal"
HEAD = 30_000  # bytes at the beginning that describe the rest; most damage is done there


class Target:
    """A finished run with damaged fields."""

    def __init__(self, folder: Path, seeds: Path | None) -> None:
        assert seeds is not None, "give a finished run by --seeds"
        self.folder = folder / "run"
        shutil.copytree(seeds, self.folder)
        self.whole = (seeds / NAME).read_bytes()
        self.body = Run(self.folder).body
        self.check()

    def lay(self, choices: Choices) -> str:
        head, rest = self.whole[:HEAD], self.whole[HEAD:]
        if chance(choices, 30):
            rest = edited(choices, rest, most=2)
        head = edited(choices, head)
        (self.folder / NAME).write_bytes(head + rest)
        (self.folder / JOURNAL).unlink(missing_ok=True)
        if chance(choices, 20):
            (self.folder / JOURNAL).write_bytes(edited(choices, b"viscopoint journal\n" + bytes(5000)))
        return f"{len(head)} + {len(rest)} bytes"

    def check(self) -> None:
        run = Run(self.folder)
        run.body = self.body
        for number in range(min(len(run.times), 3)):
            run.profile(run.snapshot(number))
