"""Case files, changes of ``--set`` and another method: what ``viscopoint run`` reads before it does anything."""

import contextlib
import io
import tomllib
from importlib import resources
from pathlib import Path

from choices import Choices, chance, one_of
from edits import NUMBERS, TEXTS, edited

import viscopoint as vp
from viscopoint.case.case import METHODS, changes_of, packaged
from viscopoint.case.description import description
from viscopoint.command_line.terminal import console
from viscopoint.messages import unseen

MODULES = (
    "tomllib._parser", "viscopoint.errors", "viscopoint.messages", "viscopoint.results.safe_read",
    "viscopoint.case.units",
    "viscopoint.case.explain", "viscopoint.case.rules", "viscopoint.case.tables", "viscopoint.case.case",
    "viscopoint.methods.mpm.inputs",
    "viscopoint.methods.fem.inputs", "viscopoint.methods.tlmpm.inputs",
)  # fmt: skip
UNITS = (
    "mm", "m", "um", "us", "ms", "s", "MPa", "GPa", "1/ms", "m/s", "g/cm^3", "kg/m**3", "N/mm^2", "mm^9^9", "m^-9",
    "degC", "dB", "K", "percent", "", "mm*mm/mm", "ly", "eV", "m" * 90, "1/" * 40 + "m", "delta_degF", "inch", "%",
    "µs", "μs", "(mm)", "ton", "tonne/mm^3", "g/cm³", "N/mm2", "/ms", "ms⁻¹", "kg·m^-3", "ksi", "mPa", "Mm", "rpm",
)  # fmt: skip
SIZES = (
    "rod.radius", "rod.length", "impact.gap", "impact.speed", "method.size", "method.spacing", "method.cell",
    "time.end", "method.box.low", "method.box.high", "method.grading",
)  # fmt: skip
EXTREMES = (
    "1e-15 mm",
    "1e15 mm",
    "1e-6 mm",
    "1e6 mm",
    "1e15 m/s",
    "1e-15 ms",
    "1e15 ms",
    "100",
    "0.01",
    "0 mm",
    "-1 mm",
)
VALUES = (
    "[]", "{}", "true", "''", "[[]]", "{name='fem', mesh='rod.vtu'}", "{name='fem', mesh='../outside/canary.toml'}",
    "{law='elastic'}", "{name='mpm', cell='0 mm'}", "['1 us', '2 us']", "['1 us'," + "'1e-9 us'," * 3000 + "]",
    "[" * 500, "1979-05-27", "{a.b.c=1}", "0x" + "f" * 5000, "9" * 5000, "-0.0", "nan", "'\\u001b[31m'", "'\\u202e'",
    "\"x\"", "'''",
)  # fmt: skip


class Target:
    """One file, with changes."""

    def __init__(self, folder: Path, seeds: Path | None) -> None:
        self.file = folder / "case.toml"
        (folder / "rod.vtu").write_bytes(b"no mesh")
        files = resources.files("viscopoint.case.library")
        texts = [(files / f"{name}.toml").read_text() for name in packaged()]
        texts += [vp.Case.load(name, method=method).resolved().to_toml() for name in packaged() for method in METHODS]
        texts += [(files / "starter.txt").read_text(), 'extends = "paper"\n[method]\nname = "fem"\nmesh = "rod.vtu"\n']
        self.texts = [text.encode() for text in texts]
        self.keys = sorted({key for text in texts for key in _keys(text)} | {"a.b.c", "x" * 300})
        self.changes: list[str] = []
        self.method: str | None = None

    def lay(self, choices: Choices) -> str:
        pieces = (*map(str.encode, UNITS), *map(str.encode, VALUES), b'extends = "paper"\n')
        text = one_of(choices, self.texts)
        if not chance(choices, 30):
            text = edited(choices, text, pieces)
        self.changes = [self._change(choices) for _ in range(choices.integer(0, 4))]
        self.method = one_of(choices, (None, None, *METHODS, "papr"))
        self.file.write_bytes(text)
        return f"{text[:3000]!r} --set {self.changes!r:.3000} --method {self.method}"

    def _change(self, choices: Choices) -> str:
        key = one_of(choices, self.keys)
        if chance(choices, 5):
            key = edited(choices, key.encode(), most=1).decode(errors="replace").replace("\0", "")
        kind = choices.integer(0, 5)
        if kind > 3:
            return f"{one_of(choices, SIZES)}={one_of(choices, EXTREMES)}"
        if kind == 0:
            return f"{key}={one_of(choices, VALUES)}"
        if kind == 1:
            return f"{key}={one_of(choices, NUMBERS).decode()}"
        if kind == 2:
            return f"{key}={one_of(choices, NUMBERS).decode()} {one_of(choices, UNITS)}"
        return f"{key}='{one_of(choices, TEXTS).decode(errors='replace')}'"

    def check(self) -> None:
        case = vp.Case.load(self.file, changes_of(self.changes), method=self.method)
        assert unseen(case.title) is None
        assert case.method.need(case.rod).size >= 0.0
        assert vp.Case.from_tables(case.resolved().to_tables()) == case.resolved()
        with contextlib.redirect_stdout(io.StringIO()):
            console().print(case.title, markup=False)
        assert unseen(description(case)) is None


def _keys(text: str) -> list[str]:
    """Return the dotted keys of TOML."""

    def walk(tables: dict[str, object], prefix: str = "") -> list[str]:
        found: list[str] = []
        for key, value in tables.items():
            found.append(prefix + key)
            if isinstance(value, dict):
                found += walk(value, f"{prefix}{key}.")
        return found

    return walk(tomllib.loads(text))
