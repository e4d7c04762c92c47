"""The cases of the paper's figures, by the names under which their runs are kept."""

from collections.abc import Iterator

from viscopoint.case.case import Case

DECAYS = ("6.5", "65", "650")  # beta, 1/ms
METHODS = ("fem", "mpm")
RESOLUTIONS = ("paper", "fine")
SNAPSHOTS = ["5 us", "10 us", "15 us", "20 us"]
HALVED = {  # the paper's 2.28 points in a cell, elements as wide as the points are apart
    "fem": {"method.size": "0.19 mm"},
    "mpm": {"method.spacing": "0.19 mm", "method.cell": "0.25 mm"},
}
WIDE = {"method.box.x": ["-13 mm", "13 mm"], "method.box.y": ["-13 mm", "13 mm"]}  # feet grow beyond the paper's box


def paper_case(method: str, decay: str, *, elastic: bool = False, resolution: str = "paper") -> Case:
    """Return the paper's rod for a decay constant [1/ms]; ``elastic``: long-time modulus raised to the short one."""
    changes: dict[str, object] = {"material.decay": f"{decay} 1/ms", "time.snapshots": SNAPSHOTS}
    changes |= {"material.shear_long": "140 MPa"} if elastic else {}
    changes |= HALVED[method] if resolution == "fine" else {}
    return Case.load("paper", changes, method=method)


def printed_case(decay: str) -> Case:
    """Return the paper's rod with a decay constant in the unit that the paper prints, 1/us."""
    return Case.load("paper", {"material.decay": f"{decay} 1/us", "time.snapshots": SNAPSHOTS, **WIDE})


def main_cases(resolution: str) -> Iterator[tuple[str, Case]]:
    """Yield name and case of the twelve runs that the paper's figures show: "fem-650", "mpm-elastic-6.5" and so on."""
    for decay in DECAYS:
        for method in METHODS:
            yield f"{method}-{decay}", paper_case(method, decay, resolution=resolution)
        for method in METHODS:
            yield f"{method}-elastic-{decay}", paper_case(method, decay, elastic=True, resolution=resolution)


def printed_cases() -> Iterator[tuple[str, Case]]:
    """Yield name and case of the runs in the printed unit: "printed-650" and so on."""
    for decay in DECAYS:
        yield f"printed-{decay}", printed_case(decay)
