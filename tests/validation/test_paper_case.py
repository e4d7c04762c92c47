"""The paper's rod, against what the paper shows and what public codes give on the same lattice, grid and law."""

import pytest

import viscopoint as vp


@pytest.fixture(scope="module")
def runs() -> dict[str, vp.Run]:
    """The paper's four packaged cases."""
    return {name: vp.run(vp.Case.load(name), figures=False) for name in vp.packaged() if name.startswith("paper")}


def last(run: vp.Run) -> dict[str, float]:
    return run.summary["snapshots"][-1]


def test_every_case_runs_to_the_end_with_a_closed_balance(runs: dict[str, vp.Run]):
    for run in runs.values():
        assert run.status == "complete"
        # a regression bound: 0.4 to 1.1 % was measured at this step; the order in the step is in test_conservation
        assert run.summary["energy_error [%]"] < 1.5
        # impulse and momentum are both sums over some 1e4 points and 1e2 steps of terms below 200 N ms
        assert run.summary["momentum_error [N ms]"] < 1e-10
        assert last(run)["lost"] == 0


def test_elastic_control_agrees_with_public_codes(runs: dict[str, vp.Run]):
    # trilinear MUSL in three public codes at 20 us: points from 0.13 to 22.26 mm, greatest radius 4.18 to 4.20 mm,
    # -72 to -75 m/s. One layer of points is 0.38 mm, a step moves a point by 0.013 mm.
    end = last(runs["paper-elastic"])
    assert end["lowest_point"] == pytest.approx(0.13, abs=0.02)
    assert end["highest_point"] == pytest.approx(22.26, abs=0.02)
    assert end["widest_point"] == pytest.approx(4.19, abs=0.03)
    # how much too soft a trilinear rod is depends on where its points stand in their cells, and so on where the grid
    # begins, which the codes choose each for itself: half a cell lower is worth 3.4 m/s (docs/verification.md)
    assert end["velocity"] == pytest.approx(-73.5, abs=3.4)


@pytest.mark.parametrize(("name", "radius"), [("paper-6.5", 4.20), ("paper-65", 4.39), ("paper", 5.37)])
def test_greatest_radius_is_that_of_the_trial_that_decoded_the_units(runs: dict[str, vp.Run], name: str, radius: float):
    # an independent trial program, trilinear MUSL on the paper's grid; 0.05 mm is a tenth of a cell
    assert last(runs[name])["widest_point"] == pytest.approx(radius, abs=0.05)


def test_mushroom_grows_with_the_decay_constant(runs: dict[str, vp.Run]):
    # Figure 5: hardly any change at 6.5, clear growth at 65 and more at 650
    radii = [last(runs[name])["greatest_radius"] for name in ("paper-elastic", "paper-6.5", "paper-65", "paper")]
    growth = [radius - 3.8 for radius in radii]
    assert growth[1] == pytest.approx(growth[0], rel=0.1)
    assert growth[1] < growth[2] < growth[3]
    assert growth[3] > 3 * growth[1]


def test_an_elastic_wave_runs_up_the_rod_and_relaxation_stops_it(runs: dict[str, vp.Run]):
    # Figure 6. In a thin elastic rod a wave of c0 = 622 mm/ms has brought 12.4 mm to rest by 20 us: 4.4 mm of the
    # 17.5 mm above z = 8 mm. With decay 650 1/ms its front has fallen to 2.4 % of the impact speed there.
    def slowed(run: vp.Run) -> float:
        above = run.body.position[:, 2] > 8.0
        return float(run.snapshot("20 us")["velocity"][above, 2].mean() + 150.0)

    assert slowed(runs["paper-6.5"]) == pytest.approx(150.0 * 4.4 / 17.5, rel=0.2)  # lateral inertia smears the front
    assert 0.0 < slowed(runs["paper"]) < 0.05 * 150.0


def test_decay_constant_has_no_effect_without_an_arm(runs: dict[str, vp.Run]):
    # Figure 7: with G_inf = G_0 the three decay constants give the same
    other = vp.run(vp.Case.load("paper-elastic", {"material.decay": "6.5 1/ms"}), figures=False)
    assert (other.snapshot(-1)["position"] == runs["paper-elastic"].snapshot(-1)["position"]).all()
