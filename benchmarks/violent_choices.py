"""Which choices of `name = "mpm"` survive violent cases on half a section: the table of docs/methods.md.

python benchmarks/violent_choices.py   # some minutes, most of them compiling
"""

from convergence import table

import viscopoint as vp
from viscopoint.model.build import build
from viscopoint.model.energy_balance import Row
from viscopoint.model.simulation import Simulation

PAPER = {
    "law": "linear-viscoelastic", "density": "1 g/cm^3", "bulk": "550 MPa", "shear_short": "140 MPa",
    "shear_long": "5 MPa", "decay": "650 1/ms",
}  # fmt: skip
ELASTIC = {**PAPER, "shear_long": "140 MPa"}
SOFT = {**PAPER, "bulk": "100 MPa", "shear_short": "2 MPa", "shear_long": "0.5 MPa", "decay": "100 1/ms"}
RELAXED = {**PAPER, "shear_short": "1400 MPa", "shear_long": "0.14 MPa", "decay": "1e6 1/ms"}
COPPER = vp.Case.load("copper").to_tables()["material"]
DISC = {"law": "elastic", "density": "1 g/cm^3", "bulk": "833.33 kPa", "shear": "384.6 kPa"}
CASES = {  # material, radius, length, gap (mm), speed (m/s), end (us)
    "β = 650": (PAPER, 3.8, 25.4, 0.01, 150, 100),
    "β = 650, 300 m/s": (PAPER, 3.8, 25.4, 0.01, 300, 60),
    "β = 650, 500 m/s": (PAPER, 3.8, 25.4, 0.01, 500, 40),
    "elastic": (ELASTIC, 3.8, 25.4, 0.01, 150, 100),
    "elastic, 300 m/s": (ELASTIC, 3.8, 25.4, 0.01, 300, 60),
    "soft rubber": (SOFT, 5.0, 25.0, 0.0, 200, 60),
    "relaxing at once": (RELAXED, 3.8, 25.4, 0.0, 150, 20),
    "copper, 400 m/s": (COPPER, 3.2, 32.4, 0.01, 400, 80),
    "elastic disc": (DISC, 10.0, 10.0, 0.5, 5, 3000),
}
CHOICES = {
    "gimp, flip": {},
    "gimp, flip, 1 % PIC": {"pic_fraction": 0.01},
    "gimp, apic": {"transfer": "apic"},
    "gimp, tpic": {"transfer": "tpic"},
    "quadratic, flip": {"shape": "quadratic"},
    "cpgimp, flip": {"shape": "cpgimp"},
    "cubic, flip": {"shape": "cubic"},
    "gimp, flip, nodes": {"contact": "nodes"},
}


def case(name: str, choices: dict[str, object]) -> vp.Case:
    """Return a case in a box that holds its rebound, with a guard that lets errors be seen."""
    material, radius, length, gap, speed, end = CASES[name]
    wide, cell = f"{8 * radius} mm", f"{radius / 5!r} mm" if name != "elastic disc" else "1 mm"
    spacing = f"{radius / 10!r} mm" if name != "elastic disc" else "0.5 mm"
    box = {"x": [f"-{wide}", wide], "y": [f"-{wide}", wide], "z": [f"{-gap} mm", f"{6 * length} mm"]}
    return vp.Case.from_tables({
        "rod": {"radius": f"{radius} mm", "length": f"{length} mm"},
        "impact": {"speed": f"{speed} m/s", "gap": f"{gap} mm"},
        "material": material,
        "method": {
            "name": "mpm", "geometry": "axisymmetric", "cell": cell, "spacing": spacing, "box": box, **choices,
        },
        "time": {"end": f"{end} us", "snapshots": []},
        "output": {"history": {"every": f"{end / 200} us"}},
        "guards": {"energy_error": 10.0},
    })  # fmt: skip


def measured(name: str, choices: dict[str, object]) -> str:
    """Return least and greatest energy error [%], greatest radius, length and velocity at the end."""
    simulation = Simulation(build(case(name, choices)))
    simulation.run()
    numerical = simulation.history.rows()[:, Row._fields.index("numerical")]
    lost, last = 100 * numerical / simulation.balances[0].start.kinetic, simulation.history.newest
    return f"{lost.min():+.1f}, {lost.max():+.1f}; {last.greatest_radius:.2f}, {last.length:.2f}, {last.velocity:.2f}"


if __name__ == "__main__":
    table(
        ("case", *CHOICES),
        [[name, *(measured(name, choices) for choices in CHOICES.values())] for name in CASES],
    )
