"""What hourglass control takes is shown, marked and bounded."""

import pytest

import viscopoint as vp

SOFT = {
    "title": "soft rubber, fast",
    "rod": {"radius": "5 mm", "length": "25 mm"}, "impact": {"speed": "200 m/s"},
    "material": {
        "law": "linear-viscoelastic", "density": "1 g/cm^3", "bulk": "100 MPa", "shear_short": "2 MPa",
        "shear_long": "0.5 MPa", "decay": "100 1/ms",
    },
    "method": {"name": "fem", "size": "1 mm"}, "time": {"end": "60 us"},
}  # fmt: skip


def test_hourglass_control_that_takes_a_sixth_of_the_internal_energy_is_marked():
    case = vp.Case.from_tables(SOFT | {"guards": {"hourglass_share": 1.0}})
    with pytest.warns(vp.ResultWarning, match=r"hourglass control took 1\d\.\d % .* method.element = \"selective\""):
        run = vp.run(case, figures=False)
    end = run.rows[-1]
    # the internal energy grew to the end: its greatest is the last
    assert end.hourglass_share == pytest.approx(100.0 * end.hourglass / (end.stored + end.dissipated), rel=1e-12)
    assert end.hourglass_share > 10.0
    assert run.summary["hourglass_share [%]"] == pytest.approx(max(run.columns["hourglass_share"]), rel=1e-12)
    assert (run.columns["hourglass_share"][1:] >= 0.0).all()


def test_hourglass_control_that_takes_over_a_tenth_stops_the_run():
    run = vp.run(vp.Case.from_tables(SOFT), figures=False)
    assert run.status == "stopped"
    assert "guards.hourglass_share allows 10 %" in run.results.reason
    assert 'take method.element = "selective"' in run.results.reason


def test_elements_without_hourglass_modes_are_not_marked():
    method = {"name": "fem", "size": "1 mm", "element": "selective", "geometry": "axisymmetric"}
    run = vp.run(vp.Case.from_tables(SOFT | {"method": method, "time": {"end": "20 us"}}), figures=False)
    assert (run.status, run.results.hourglass_share, run.results.warnings) == ("complete", 0.0, [])
