"""How the contact line converges under friction: axisymmetric runs of paper-65 at ever finer distances.

    python benchmarks/friction.py [FRICTION]

Prints the contact radius, the impact face's, the greatest radius and the wall impulse at 20 us, a line for each method
and distance, and what Richardson's extrapolation makes of the last three. At the finest it takes some minutes.
"""

import sys
import warnings

import numpy as np

import viscopoint as vp

SIZES = (0.38, 0.19, 0.095, 0.0475)  # mm
QUANTITIES = ("contact_radius", "impact_face_radius", "greatest_radius", "wall_impulse", "friction")
VARIANTS = {
    "fem, one-point": ("fem", {"element": "one-point"}),
    "fem, selective": ("fem", {"element": "selective"}),
    "tlmpm": ("tlmpm", {}),
    "mpm": ("mpm", {}),
}


def case_of(method: str, choices: dict[str, str], size: float, friction: float) -> vp.Case:
    """Return the case at a distance of nodes or points."""
    distance = {"size" if method == "fem" else "spacing": f"{size} mm"}
    distance |= {"cell": f"{2 * size} mm"} if method == "mpm" else {}
    tables = vp.Case.load("paper-65").to_tables()
    tables |= {"method": {"name": method, "geometry": "axisymmetric", **choices, **distance}}
    tables["impact"] |= {"friction": friction, "gap": "0 mm"}
    tables["time"] = {"end": "20 us", "snapshots": []}
    return vp.Case.from_tables(tables)


def extrapolated(values: list[float]) -> str:
    """Return the limit and order of three values at halved distances, if they converge."""
    first, second, third = values
    ratio = (second - first) / (third - second) if third != second else np.nan
    if not ratio > 1.0:
        return "does not converge"
    return f"{third + (third - second) / (ratio - 1.0):.4f} (order {np.log2(ratio):.2f})"


def main() -> None:
    friction = float(sys.argv[1]) if len(sys.argv) > 1 else 0.2
    warnings.simplefilter("ignore", vp.ResultWarning)
    print("| method | distance (mm) |", " | ".join(QUANTITIES), "| status |")
    for name, (method, choices) in VARIANTS.items():
        found: list[list[float]] = []
        for size in SIZES:
            run = vp.run(case_of(method, choices, size, friction), figures=False)
            end = run.rows[-1]
            found.append([getattr(end, quantity) for quantity in QUANTITIES])
            print(f"| {name} | {size} |", " | ".join(f"{value:.4f}" for value in found[-1]), f"| {run.status} |")
        limits = [extrapolated([row[column] for row in found[1:]]) for column in range(len(QUANTITIES))]
        print(f"| {name} | limit |", " | ".join(limits), "| |", flush=True)


if __name__ == "__main__":
    main()
