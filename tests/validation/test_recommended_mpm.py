"""What docs/methods.md recommends of `name = "mpm"`: runs finish within the energy guard, and agree with elements."""

from typing import Any

import pytest

import viscopoint as vp

PAPER = {
    "law": "linear-viscoelastic", "density": "1 g/cm^3", "bulk": "550 MPa", "shear_short": "140 MPa",
    "shear_long": "5 MPa", "decay": "650 1/ms",
}  # fmt: skip
SOFT = {**PAPER, "bulk": "100 MPa", "shear_short": "2 MPa", "shear_long": "0.5 MPa", "decay": "100 1/ms"}
ELASTIC = {**PAPER, "shear_long": "140 MPa"}


def rod(material: dict[str, str], speed: float, radius: float, end: float, compared: float) -> vp.Case:
    """Return half a section of a rod to ``end`` [us], ten points to the radius, by no method in particular."""
    return vp.Case.from_tables({
        "rod": {"radius": f"{radius} mm", "length": "25 mm"},
        "impact": {"speed": f"{speed} m/s"},
        "material": material,
        "method": {"name": "tlmpm", "geometry": "axisymmetric", "spacing": f"{radius / 10} mm"},
        "time": {"end": f"{end} us", "snapshots": [f"{compared} us"]},
        "output": {"history": {"every": "0.5 us"}},
    })  # fmt: skip


def by(case: vp.Case, method: str, **changes: Any) -> vp.Run:
    """Run a case by another method at the same distance, with that method's defaults."""
    table = {"name": method, "geometry": "axisymmetric"} | changes
    size = f"{case.method.resolution()} mm"
    table |= {"size": size} if method == "fem" else {"spacing": size, "cell": f"{2 * case.method.resolution()} mm"}
    return vp.run(vp.Case.from_tables(case.to_tables() | {"method": table}), figures=False)


# material, speed (m/s), radius (mm), end (us), and when elements of this size are still whole (us)
VIOLENT = {
    "softest": (PAPER, 150.0, 3.8, 100.0, 80.0),
    "twice as fast": (PAPER, 300.0, 3.8, 60.0, 40.0),
    "elastic, elements tangle at 12 us": (ELASTIC, 300.0, 3.8, 60.0, 9.0),
    "rubber, elements tangle at 23 us": (SOFT, 200.0, 5.0, 60.0, 10.0),
}


@pytest.mark.parametrize("name", VIOLENT)
def test_violent_rods_finish_within_the_guard_and_agree_with_elements_while_these_are_whole(name: str):
    case = rod(*VIOLENT[name])
    run, compared = by(case, "mpm"), case.time.snapshots.times[0]
    assert run.status == "complete"
    assert run.results.energy_error < 2.5  # %; 0.4 to 2.1 measured, and 5 stop a run
    reference = by(case.with_({"time.end": f"{compared} ms", "time.snapshots": []}), "fem", element="selective")
    assert reference.status == "complete"
    found, exact = run.rows[1], reference.rows[-1]
    spacing, rest = case.method.resolution(), case.rod
    # the outermost ring is known to half its width, which stretches with the foot; the rubber flows out in a lip
    # thinner than a cell: its end is known to a cell
    width = spacing * exact.greatest_radius / rest.radius
    assert found.greatest_radius == pytest.approx(
        exact.greatest_radius, abs=2 * spacing if "rubber" in name else 0.5 * width
    )
    # one layer of points is stopped early or late
    layer = spacing / rest.length
    assert found.velocity == pytest.approx(exact.velocity, abs=layer * case.impact.speed)
    assert found.length == pytest.approx(exact.length, abs=spacing)


@pytest.mark.long
@pytest.mark.parametrize("shape", ["quadratic", "cpgimp"])
def test_shapes_for_feet_that_spread_far_keep_the_length_at_500_metres_a_second(shape: str):
    """The foot reaches 3.5 radii. Boxes that do not stretch come apart: 4.9 instead of 5.8 mm of length."""
    case = rod(PAPER, 500.0, 3.8, 40.0, 20.0)
    found, reference = by(case, "mpm", shape=shape), by(case, "fem", element="selective")
    assert (found.status, reference.status) == ("complete", "complete")
    assert found.results.energy_error < 2.5
    for mine, exact in zip(found.rows[1:], reference.rows[1:], strict=True):
        spacing = case.method.resolution()
        assert mine.length == pytest.approx(exact.length, abs=spacing)
        assert mine.greatest_radius == pytest.approx(
            exact.greatest_radius, abs=0.5 * spacing * exact.greatest_radius / 3.8
        )
        assert mine.velocity == pytest.approx(exact.velocity, abs=spacing / 25.0 * 500.0)


def disc(spacing: float, **choices: str) -> vp.Run:
    """Let an elastic disc bounce off the wall, by default choices but for those given."""
    return vp.run(vp.Case.from_tables({
        "rod": {"radius": "10 mm", "length": "10 mm"},
        "impact": {"speed": "5 m/s", "gap": "0.5 mm"},
        "material": {"law": "elastic", "density": "1 g/cm^3", "bulk": "833.33 kPa", "shear": "384.6 kPa"},
        "method": {
            "name": "mpm", "geometry": "axisymmetric", "spacing": f"{spacing} mm", "cell": f"{2 * spacing} mm",
            **choices,
        },
        "time": {"end": "3 ms", "snapshots": []},
        "output": {"history": {"every": "5 us"}},
    }), figures=False)  # fmt: skip


def test_an_elastic_disc_rebounds_as_elements_and_total_lagrangian_points_say():
    """3.57 to 3.58 m/s, with first order in the cell: what the wall takes as it stops the lowest nodes."""
    coarse, fine = disc(0.5), disc(0.25)
    for run in (coarse, fine):
        assert run.status == "complete"
        assert run.results.energy_error < 2.5  # %, as of all cases of docs/methods.md
    slow, fast = (run.rows[-1].velocity for run in (coarse, fine))
    assert slow < fast < 3.575
    assert 2 * fast - slow == pytest.approx(3.575, abs=0.05)  # a quarter of what halving the cell brings


@pytest.mark.long
@pytest.mark.parametrize("shape", ["cpgimp", "gimp"])
def test_other_shapes_bounce_alike(shape: str):
    coarse, fine = (disc(spacing, shape=shape) for spacing in (0.5, 0.25))
    assert max(run.results.energy_error for run in (coarse, fine)) < 2.5
    assert 2 * fine.rows[-1].velocity - coarse.rows[-1].velocity == pytest.approx(3.575, abs=0.05)


def test_nodal_contact_with_large_cells_is_stopped_for_the_energy_that_it_gains():
    """What docs/methods.md says against it: the wall acts a cell early, on a disc of ten cells."""
    run = disc(0.5, contact="nodes")
    assert run.status == "stopped"
    assert "gained" in run.results.reason
