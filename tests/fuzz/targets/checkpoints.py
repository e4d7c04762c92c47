"""Checkpoints from others: damaged ones, and ones that are whole but hold what no run ever had."""

import shutil
import struct
from pathlib import Path

import numpy as np
from choices import Choices, chance, one_of
from edits import edited

import viscopoint as vp
from viscopoint.case.case import Case
from viscopoint.errors import InputError
from viscopoint.kernels.arrays import AnyArray
from viscopoint.model.build import build
from viscopoint.model.energy_balance import Row
from viscopoint.model.simulation import Simulation
from viscopoint.results import checkpoint
from viscopoint.results.checkpoint import Checkpoint
from viscopoint.results.output import OUTPUTS
from viscopoint.results.run import Run

MODULES = ("viscopoint.errors", "viscopoint.results.checkpoint")
CASE = {"method.spacing": "1.9 mm", "method.geometry": "axisymmetric", "time.end": "4 us", "time.snapshots": ["2 us"]}
WILD = (np.nan, np.inf, -np.inf, 0.0, -1.0, 1e-320, 1e308, -1e308, 1e15, 255.0, 2.0**31, 2.0**63)
WILD_COUNTS = (-1, 0, 10**9, 2**63)
GO_ON = 3  # percent of what is whole: to resume takes longer than to read


class Target:
    """A run that was cut off, and what happens to the newest of its checkpoints."""

    def __init__(self, folder: Path, seeds: Path | None) -> None:
        self.folder, self.sound, self.resumed = folder / "run", folder / "sound", False

        def end(share: float, row: Row) -> None:
            if share > 0.7:
                raise KeyboardInterrupt

        case = Case.load("paper", CASE, method="tlmpm")
        vp.run(case, self.sound, figures=False, checkpoint_every="0.5 us simulated", watch=end)
        model = build(Run(self.sound).case)
        self.like = Simulation(model, [make(self.sound, model) for make in OUTPUTS.values()]).state()
        self.files = sorted((self.sound / checkpoint.FOLDER).iterdir())
        self.whole = self.files[-1].read_bytes()
        self.read = checkpoint.load(self.files[-1], self.like)
        self._lay_sound()
        vp.resume(self.folder, figures=False)  # what is imported and compiled only when needed

    def _lay_sound(self) -> None:
        shutil.rmtree(self.folder, ignore_errors=True)
        shutil.copytree(self.sound, self.folder)

    def lay(self, choices: Choices) -> str:
        self.resumed = chance(choices, GO_ON)
        if self.resumed or not self.folder.exists():
            self._lay_sound()
        place = self.folder / checkpoint.FOLDER
        place.mkdir(exist_ok=True)
        for file in place.iterdir():
            file.unlink()
        file = place / self.files[-1].name
        if self.resumed or chance(choices, 30):
            found, told = self._hostile(choices)
            checkpoint.save(file, *found)
            return told
        head = 8 + struct.unpack("<Q", self.whole[:8])[0]
        content = edited(choices, self.whole[:head], (b'"__metadata__":{}', b'"dtype":"F64"', b'"shape":[1,1]'))
        content += edited(choices, self.whole[head:]) if chance(choices, 30) else self.whole[head:]
        file.write_bytes(content)
        return f"{content[:2000]!r}"

    def _hostile(self, choices: Choices) -> tuple[Checkpoint, str]:
        """Return a checkpoint of the right shape with wrong numbers, whose checksum is right."""
        told, state = [], {name: np.array(rows) for name, rows in self.read.state.items()}
        for _ in range(choices.integer(0, 3)):
            name = one_of(choices, sorted(name for name, rows in state.items() if rows.size))
            told.append(f"{name}: {_spoilt(choices, state[name])}")
        words = self.read.words.model_copy(deep=True)
        for _ in range(choices.integer(0, 2)):
            name = one_of(choices, sorted(type(words).model_fields))
            value = getattr(words, name)
            if isinstance(value, float):
                setattr(words, name, one_of(choices, WILD))
            elif isinstance(value, int):
                setattr(words, name, one_of(choices, WILD_COUNTS))
            told.append(f"{name}: {getattr(words, name)!r:.200}")
        return Checkpoint(words, state), "; ".join(told)

    def check(self) -> None:
        if self.resumed:
            vp.resume(self.folder, figures=False)
            return
        found, faults = checkpoint.newest(self.folder, self.like)
        if found is None:
            raise InputError(str(faults))


def _spoilt(choices: Choices, rows: AnyArray) -> str:
    flat = rows.reshape(-1)
    value, place = one_of(choices, WILD), choices.integer(0, flat.size - 1)
    with np.errstate(all="ignore"):
        kept = value if rows.dtype.kind == "f" else int(np.nan_to_num(value)) % 256
        flat[place if chance(choices, 50) else slice(None)] = kept
    return f"{kept} at {place}"
