"""Records the numbers of many runs, and holds them against those of another state of the sources.

    python benchmarks/same_numbers.py record numbers.npz            # before a change
    python benchmarks/same_numbers.py compare numbers.npz           # after it
    python benchmarks/same_numbers.py compare numbers.npz --only fem

All methods, elements, shape functions, transfers, schemes and materials on small rods, and, with ``--paper``, the
paper's four materials by each method at the paper's resolution. Only what users call is called, so that the script runs
on both states. A row says how far the last row of history and the last fields of a run are off: "same bits", or the
greatest difference over the greatest value of the same quantity.
"""

import argparse
import sys
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

import viscopoint as vp

ENERGIES = ("kinetic", "stored", "dissipated", "hypoelastic", "viscous", "hourglass", "eroded", "contact", "friction")
ROW = (*ENERGIES, "length", "contact_radius", "greatest_radius", "velocity", "momentum", "wall_impulse")

SMALL = {"time.end": "20 us", "time.snapshots": ["10 us"]}
MPM = {"method.cell": "1 mm", "method.spacing": "0.76 mm"}
PAPER = {"density": "1 g/cm^3", "bulk": "550 MPa"}
ARM = {"shear_short": "140 MPa", "shear_long": "5 MPa", "decay": "650 1/ms"}
YIELDING = {"yield_stress": "20 MPa", "hardening": "10 MPa"}
LAWS: dict[str, dict[str, str]] = {
    "linear-viscoelastic": PAPER | ARM,
    "elastic": PAPER | {"shear": "140 MPa"},
    "elastic-plastic": PAPER | {"shear": "140 MPa"} | YIELDING,
    "linear-viscoelastic-plastic": PAPER | ARM | YIELDING,
}
METHODS: dict[str, dict[str, Any]] = {
    "mpm": {"name": "mpm", "cell": "1 mm", "spacing": "0.5 mm"},
    "mpm axisymmetric": {"name": "mpm", "cell": "0.5 mm", "spacing": "0.25 mm", "geometry": "axisymmetric"},
    "tlmpm": {"name": "tlmpm", "spacing": "0.76 mm"},
    "tlmpm axisymmetric": {"name": "tlmpm", "spacing": "0.38 mm", "geometry": "axisymmetric"},
    "fem": {"name": "fem", "size": "0.8 mm"},
    "fem selective": {"name": "fem", "size": "0.8 mm", "element": "selective"},
    "fem axisymmetric": {"name": "fem", "size": "0.38 mm", "geometry": "axisymmetric"},
    "fem axisymmetric selective": {
        "name": "fem", "size": "0.38 mm", "geometry": "axisymmetric", "element": "selective"
    },
}  # fmt: skip
VARIANTS: dict[str, list[dict[str, Any]]] = {
    "mpm": [
        {"shape": "trilinear", "contact": "nodes", "fill": "lattice"},
        {"shape": "trilinear", "volume": "cell-mean"},
        {"shape": "gimp"},
        {"shape": "cpgimp"},
        {"shape": "cubic"},
        {"transfer": "apic"},
        {"transfer": "tpic"},
        {"pic_fraction": 0.01},
        {"scheme": "usf"},
        {"scheme": "usl", "shape": "gimp"},
        {"volume": "cell-mean", "fill": "rings"},
        {"precision": "single"},
    ],
    "mpm axisymmetric": [{"shape": "gimp"}, {"transfer": "apic"}, {"volume": "cell-mean"}],
    "tlmpm": [{"volume": "local"}, {"shape": "gimp"}, {"fill": "rings"}, {"precision": "single"}],
    "tlmpm axisymmetric": [{"volume": "local"}],
    "fem": [
        {"hourglass": {"form": "viscous"}},
        {"delete_below": 0.5},
        {"grading": 1.5},
        {"precision": "single"},
    ],
    "fem selective": [{"precision": "single"}],
    "fem axisymmetric": [{"hourglass": {"form": "viscous"}}, {"precision": "single"}],
    "fem axisymmetric selective": [{"precision": "single"}],
}
IMPACTS: dict[str, dict[str, Any]] = {
    "friction 0.1": {"impact.friction": 0.1},
    "no-separation": {"impact.wall": "no-separation", "impact.gap": "0 mm"},
}
LOOSE = {"guards.energy_error": 0.5, "guards.lost_share": 1.0, "guards.hourglass_share": 10.0, "guards.mass_error": 0.5}
OF_THE_PAPER = ("paper", "paper-65", "paper-6.5", "paper-elastic")
BY: dict[str, dict[str, Any] | None] = {
    "as the paper": None,
    "recommended mpm": {"name": "mpm", "cell": "0.76 mm", "spacing": "0.38 mm"},
    "tlmpm": {"name": "tlmpm", "spacing": "0.38 mm"},
    "fem one-point": {"name": "fem", "size": "0.4 mm"},
    "fem selective": {"name": "fem", "size": "0.4 mm", "element": "selective"},
}


def cases(paper: bool) -> Iterator[tuple[str, vp.Case]]:
    """Yield what runs, by name."""
    afresh = {"name": "fem", "size": "1 mm"}  # tables of the paper's own method would be merged with its choices
    rod = vp.Case.load("paper", SMALL | LOOSE).with_(method=afresh)
    if paper:
        for name in OF_THE_PAPER:
            for by, table in BY.items():
                case = vp.Case.load(name, {"time.end": "20 us", "time.snapshots": ["20 us"]})
                yield f"{name}, {by}", case if table is None else case.with_(method=afresh).with_(method=table)
        return
    for method, table in METHODS.items():
        for law, numbers in LAWS.items():
            yield f"{method}, {law}", rod.with_(method=table, material={"law": law, **numbers})
        for variant in VARIANTS[method]:
            told = " ".join(f"{key} {value}" for key, value in variant.items())
            yield f"{method}, {told}", rod.with_(method={**table, **variant})
        for told, changes in IMPACTS.items():
            yield f"{method}, {told}", rod.with_(changes).with_(method=table)


def numbers_of(case: vp.Case) -> dict[str, Any]:
    """Run a case and return the last row of its history and the last of its fields."""
    run = vp.run(case, figures=False, checkpoint_every="never")
    row, last = run.history.iloc[-1], run.snapshot(-1)
    fields = {name: np.asarray(last[name], float) for name in last.fields}
    return {"step": float(row["step"]), **{name: float(row[name]) for name in ROW}} | fields


def difference(name: str, before: Any, now: Any, energy: float) -> float:
    """Return the greatest difference of a quantity over its greatest value; of energies, over all there was."""
    before, now = np.asarray(before, float), np.asarray(now, float)
    if before.shape != now.shape or not np.array_equal(np.isnan(before), np.isnan(now)):
        return np.inf
    scale = energy if name in ENERGIES else np.nanmax(np.abs(before), initial=0.0)
    off = np.nanmax(np.abs(now - before), initial=0.0)
    return float(off / scale) if scale > 0.0 else float(off)


def main() -> None:
    """Record or compare."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("do", choices=("record", "compare"))
    parser.add_argument("file", type=Path)
    parser.add_argument("--paper", action="store_true", help="the paper's resolution and materials")
    parser.add_argument("--only", default="", help="runs with this in their name")
    given = parser.parse_args()
    warnings.simplefilter("ignore", vp.ViscopointWarning)
    told = np.load(given.file) if given.do == "compare" else {}
    found: dict[str, Any] = {}
    worst = 0.0
    for name, case in cases(given.paper):
        if given.only not in name:
            continue
        numbers = numbers_of(case)
        if given.do == "record":
            found |= {f"{name}: {key}": value for key, value in numbers.items()}
            print(f"{name}: {numbers['step']:.0f} steps", flush=True)
            continue
        energy = sum(abs(float(told[f"{name}: {key}"])) for key in ENERGIES)
        off = {key: difference(key, told[f"{name}: {key}"], value, energy) for key, value in numbers.items()}
        same = all(np.array_equal(told[f"{name}: {key}"], value, equal_nan=True) for key, value in numbers.items())
        key, most = max(off.items(), key=lambda item: item[1])
        worst = max(worst, most)
        print(f"{name}: {'same bits' if same else f'{most:.1e} ({key})'}", flush=True)
    if given.do == "record":
        np.savez_compressed(given.file, **found)
    else:
        print(f"greatest difference: {worst:.1e}")
        sys.exit(worst > 1e-10)


if __name__ == "__main__":
    main()
