import json
import tomllib

import pytest
from hypothesis import given
from hypothesis import strategies as st

import viscopoint as vp
from viscopoint.case.case import changes_of, merged
from viscopoint.methods.fem.inputs import FEMInput
from viscopoint.methods.mpm.contacts.gated import Gated
from viscopoint.methods.mpm.contacts.nodes import Nodes
from viscopoint.methods.mpm.inputs import BoxInput, MPMInput
from viscopoint.methods.mpm.method import MaterialPointMethod
from viscopoint.methods.mpm.shapes.gimp import Gimp
from viscopoint.methods.mpm.shapes.trilinear import Trilinear
from viscopoint.methods.mpm.volumes.cell_mean import CellMean
from viscopoint.methods.mpm.volumes.local import Local
from viscopoint.model.build import build


def faults(changes: dict[str, object], name: str = "paper") -> dict[str, str]:
    """Return the faults of a changed case by key."""
    with pytest.raises(vp.CaseError) as caught:
        vp.Case.load(name, changes)
    return {fault.key: fault.message for fault in caught.value.faults}


def test_paper_case_holds_the_paper_s_numbers():
    case = vp.Case.load("paper")
    assert (case.rod.radius, case.rod.length) == (3.8, 25.4)
    assert (case.impact.speed, case.impact.gap, case.impact.friction) == (150.0, 0.01, 0.0)
    law = case.material.build()
    assert law == pytest.approx((1e-3, 550.0, 5.0, 135.0, 650.0))
    assert isinstance(case.method, MPMInput)
    assert (case.method.cell, case.method.spacing) == (0.5, 0.38)
    assert case.time.snapshots.times == pytest.approx((0.005, 0.01, 0.02))


@pytest.mark.parametrize(
    ("name", "decay", "shear_long"),
    [("paper", 650.0, 5.0), ("paper-65", 65.0, 5.0), ("paper-6.5", 6.5, 5.0), ("paper-elastic", 650.0, 140.0)],
)
def test_packaged_cases_differ_in_what_the_paper_varies(name: str, decay: float, shear_long: float):
    case = vp.Case.load(name)
    assert (case.material.decay, case.material.shear_long) == (decay, shear_long)
    paper = vp.Case.load("paper")
    assert case.rod == paper.rod
    assert case.method == paper.method


@pytest.mark.parametrize("name", sorted(vp.packaged()))
def test_resolved_case_reads_back_as_itself(name: str):
    case = vp.Case.load(name)
    assert vp.Case.from_tables(tomllib.loads(case.to_toml())) == case


def test_units_of_the_same_dimension_are_converted():
    case = vp.Case.load("paper", {"rod.radius": "0.15 in", "impact.speed": "540 km/h", "material.bulk": "0.55 GPa"})
    assert case.rod.radius == pytest.approx(3.81)
    assert case.impact.speed == pytest.approx(150.0)
    assert case.material.bulk == pytest.approx(550.0)


@pytest.mark.parametrize(
    ("key", "value", "words"),
    [
        ("rod.raduis", "4 mm", "did you mean 'radius'"),
        ("mehtod", {}, "did you mean 'method'"),
        ("material.decy", "1 1/ms", "did you mean 'decay'"),
        ("method.box.w", ["0 mm", "1 mm"], "allowed: x, y, z"),
        ("rod.radius", "4", 'has no unit; write a length such as "0.5 mm"'),
        ("rod.radius", 4, "bare number without a unit"),
        ("rod.radius", "4 kg", "wrong dimension"),
        ("rod.radius", "4 mmm", "no known unit"),
        ("rod.radius", "four mm", "not a number"),
        ("rod.radius", "-4 mm", "must be greater than 0"),
        ("rod.radius", "0 mm", "must be greater than 0"),
        ("rod.radius", "nan mm", "not finite"),
        ("rod.radius", "inf mm", "not finite"),
        ("rod.radius", "1e999 mm", "not finite"),
        ("rod.radius", True, "bare number"),
        ("rod.radius", ["4 mm"], "not a string"),
        ("impact.friction", float("nan"), "must be finite"),
        ("impact.friction", float("inf"), "must be finite"),
        ("impact.friction", "0.3", "must be a number"),
        ("impact.friction", -0.1, "must not be less than 0"),
        ("impact.gap", "-1 mm", '"-1 mm" must not be less than 0'),
        ("material.shear_long", "200 MPa", "must not exceed material.shear_short, 140 MPa"),
        ("material.bulk", "0 MPa", "must be greater than 0"),
        ("material.decay", "-1 1/ms", "must not be less than 0"),
        ("material.decay", "650 ms", "wrong dimension"),
        ("material.law", "rubber", "allowed: elastic, elastic-plastic, linear-viscoelastic"),
        ("method.name", "sph", "allowed: fem, mpm"),
        ("method.precision", "half", '"half" is not known; allowed: double, single'),
        ("method.shape", "round", "allowed: cpgimp, cubic, gimp, quadratic, trilinear"),
        ("method.contact", "glue", "allowed: gated, nodes"),
        ("method.fill", "ring", "did you mean 'rings'"),
        ("method.volume", "mean", "allowed: cell-mean, local"),
        ("method.scheme", "musll", "did you mean 'musl'"),
        ("method.pic_fraction", 1.5, "must not be greater than 1"),
        ("method.transfer", "afic", "did you mean 'apic'"),
        ("method.order", 2, "unknown key"),  # of FMPM, which is gone
        ("method.transfer", "fmpm", '"fmpm" is not known'),
        ("method.safety", 0.0, "must be greater than 0"),
        ("method.cell", "5 mm", "larger than the rod: rod.radius is 3.8 mm"),
        ("method.spacing", "0.6 mm", "larger than method.cell, 0.5 mm"),
        ("method.box.x", ["-3 mm", "6 mm"], "cuts the rod"),
        ("method.box.y", ["-6 mm", "3 mm"], "cuts the rod"),
        ("method.box.z", ["-0.01 mm", "20 mm"], "cuts the rod"),
        ("rod.radius", "1e200 mm", "out of range"),
        ("method.spacing", "1e-110 mm", "out of range"),
        ("rod.radius", "\u0664 mm", "not a number"),
        ("method.box.x", ["-1e14 mm", "6 mm"], "at most 1,000,000 are allowed"),
        ("method.box.z", ["-0.01 mm", "1e12 mm"], "at most 1,000,000 are allowed"),
        ("method.box.z", ["0 mm", "30 mm"], "cuts the rod or the wall"),
        ("method.box.z", ["-0.21 mm", "30 mm"], "between planes of the grid"),
        ("method.box.x", ["-6 mm"], "is missing"),
        ("time.snapshots", ["5 us", "21 us", "30 us"], "21 us, 30 us: after time.end, 20 us"),
        ("time.snapshots", "5 us", "must be a list"),
        ("time.end", "0 us", "must be greater than 0"),
        ("rod", 4, "must be a table"),
        ("title", 4, "must be text"),
    ],
)
def test_a_fault_names_the_key_and_what_is_allowed(key: str, value: object, words: str):
    found = faults({key: value})
    blamed = [name for name in found if name.startswith(key) or name == f"{key}[1]"]
    assert blamed, found
    assert words in found[blamed[0]]


def test_a_missing_key_is_shown_with_an_example():
    found = faults({"material": {"law": "elastic"}})
    assert found["material.density"] == 'is missing; write a density such as "1.0 g/cm^3"'
    assert set(found) == {"material.density", "material.bulk", "material.shear"}


def test_all_faults_are_reported_at_once():
    found = faults(
        {
            "rod.length": "25.4",
            "material.shear_long": "200 MPa",  # a rule within a table that has another fault
            "material.decay": "650",
            "method.spacing": "0.6 mm",  # a rule between keys, beside a wrong word
            "method.scheme": "mussel",
            "time.snapshots": ["30 us"],
        }
    )
    assert set(found) == {
        "rod.length", "material.shear_long", "material.decay", "method.spacing", "method.scheme", "time.snapshots",
    }  # fmt: skip


def test_with_gives_a_changed_checked_copy():
    case = vp.Case.load("paper")
    by_table = case.with_(material={"decay": "65 1/ms"})
    by_key = case.with_({"material.decay": "65 1/ms"})
    assert by_table == by_key
    assert by_table.material.decay == 65.0
    assert case.material.decay == 650.0
    with pytest.raises(vp.CaseError, match=r"rod\.radius"):
        case.with_(rod={"radius": "0 mm"})


def test_a_table_of_another_law_starts_afresh():
    old = {"material": {"law": "linear-viscoelastic", "decay": "1 1/ms", "density": "1 g/cm^3"}}
    assert merged(old, {"material": {"law": "elastic", "bulk": "1 GPa"}})["material"].keys() == {"law", "bulk"}
    assert merged(old, {"material": {"decay": "2 1/ms"}})["material"].keys() == {"law", "decay", "density"}


def test_keys_of_one_transfer_are_refused_with_another():
    found = faults({"method.transfer": "apic", "method.pic_fraction": 0.1})
    assert found["method.pic_fraction"] == '0.1 blends PIC into "flip"; method.transfer is "apic"'
    assert "nodes of nearly no mass" in faults({"method.transfer": "tpic"})["method.transfer"]
    assert "nodes of nearly no mass" in faults({"method.transfer": "apic", "method.scheme": "usl"})["method.transfer"]
    vp.Case.load("paper", {"method.transfer": "tpic", "method.shape": "gimp", "method.scheme": "usl"})


def box_of(case: vp.Case) -> BoxInput:
    method = case.resolved().method
    assert isinstance(method, MPMInput)
    assert method.box is not None
    return method.box


def test_default_box_reaches_from_the_wall_around_the_rod():
    tables = vp.Case.load("paper").to_tables()
    del tables["method"]["box"]
    case = vp.Case.from_tables(tables)
    box = box_of(case)
    flight = 150.0 * 20e-3
    assert box.x == (-4 * 3.8 - flight, 4 * 3.8 + flight)
    assert box.z == (-0.01 - 2 * 0.5, 2 * 25.4 + flight)
    thick = box_of(case.with_(rod={"radius": "20 mm"}, impact={"gap": "5 mm"}))  # the box follows
    assert (thick.x, thick.z) == ((-83.0, 83.0), (-6.0, 2 * 25.4 + flight))


def test_choices_of_the_material_point_method_reach_it():
    names = {"method.shape": "gimp", "method.fill": "rings", "method.volume": "cell-mean", "method.contact": "gated"}
    model = build(vp.Case.load("paper", names))
    assert isinstance(model.method, MaterialPointMethod)
    assert model.method.shape == Gimp(0.5 * 0.38 / 0.5)
    assert model.method.volume is CellMean
    assert model.method.planes._contact is Gated
    assert len(model.body.position) == 67 * 300
    plain = build(vp.Case.load("paper")).method
    assert isinstance(plain, MaterialPointMethod)
    assert (plain.shape, plain.volume, plain.planes._contact) == (Trilinear(), Local, Nodes)
    assert len(plain.body.position) == 21_172
    assert len(plain.points.stretch) == 0  # which nobody asks for


@pytest.mark.parametrize("text", ["rod = 3 3", "\x00", "[a]\n[a]", "a = " + "[" * 5000])
def test_what_is_not_toml_is_refused(tmp_path, text: str):
    file = tmp_path / "case.toml"
    file.write_text(text)
    with pytest.raises(vp.InputError, match="not TOML"):
        vp.Case.load(file)


def test_a_case_that_is_not_there_is_refused_with_the_nearest(tmp_path):
    with pytest.raises(vp.InputError, match="did you mean 'paper-elastic'"):
        vp.Case.load("paper-elastik")
    with pytest.raises(vp.InputError, match="cannot be read"):
        vp.Case.load(tmp_path / "none.toml")
    with pytest.raises(vp.InputError, match="cannot be read"):
        vp.Case.load(tmp_path / "folder.toml" / "case.toml")


def test_a_file_may_extend_only_a_packaged_case(tmp_path):
    file = tmp_path / "mine.toml"
    file.write_text('extends = "paper-65"\n[rod]\nradius = "5 mm"\n')
    case = vp.Case.load(file)
    assert (case.rod.radius, case.material.decay) == (5.0, 65.0)
    file.write_text('extends = "../../etc/passwd"\n')
    with pytest.raises(vp.CaseError, match="no packaged case"):
        vp.Case.load(file)


def test_schema_describes_every_key_of_the_paper_s_case():
    schema = vp.Case.file_schema()
    json.dumps(schema)
    assert {"rod", "impact", "material", "method", "time", "extends"} <= set(schema["properties"])
    assert "required" not in schema["$defs"]["Rod"]
    assert schema["$defs"]["Rod"]["properties"]["radius"]["examples"] == ["0.5 mm"]
    laws = schema["properties"]["material"]["discriminator"]["mapping"]
    assert "linear-viscoelastic-plastic" in laws
    mpm = schema["$defs"]["MPMInput"]["properties"]
    assert {name: mpm[name]["enum"] for name in ("shape", "contact", "fill", "volume")} == {
        "shape": ["cpgimp", "cubic", "gimp", "quadratic", "trilinear"],
        "contact": ["gated", "nodes"],
        "fill": ["lattice", "rings", "trimmed"],
        "volume": ["cell-mean", "local"],
    }


FEM_BY_KEYS = {
    "method": {"name": "tlmpm", "spacing": "0.5 mm"},
    "method.name": "fem",
    "method.size": "0.5 mm",
    "method.hourglass": {"form": "viscous"},
    "method.hourglass.coefficient": 0.05,
    "material": {"law": "elastic", "density": "1 g/cm^3", "bulk": "1 GPa", "shear": "1 GPa"},
    "material.shear": "2 GPa",
}


@given(st.permutations(list(FEM_BY_KEYS)))
def test_changes_have_no_order(keys: list[str]):
    case = vp.Case.load("paper", {key: FEM_BY_KEYS[key] for key in keys})
    assert isinstance(case.method, FEMInput)
    assert (case.method.size, case.method.hourglass.form, case.method.hourglass.coefficient) == (0.5, "viscous", 0.05)
    assert case.material.shear == 2000.0


def test_a_table_given_whole_replaces():
    tables = {"name": "mpm", "cell": "1 mm", "spacing": "0.5 mm"}
    case = vp.Case.load("paper", {"method": tables})
    assert isinstance(case.method, MPMInput)
    assert case.method.box is None  # the paper's own is gone
    assert vp.Case.load("paper").with_({"method": tables}) == case
    merged_in = vp.Case.load("paper").with_(method=tables).method
    assert isinstance(merged_in, MPMInput)
    assert merged_in.box is not None
    assert faults({"rod": {"radius": "4 mm"}}) == {"rod.length": 'is missing; write a length such as "0.5 mm"'}


@pytest.mark.parametrize("settings", [["rod.radius=4 mm", "rod.radius=5 mm"], [" rod.radius =4 mm", "rod.radius=4 mm"]])
def test_a_key_that_is_set_twice_is_refused(settings: list[str]):
    with pytest.raises(vp.InputError, match=r"rod\.radius is set twice"):
        changes_of(settings)


def test_a_key_in_what_is_no_table_is_refused():
    with pytest.raises(vp.InputError, match=r"rod\.radius\.x: cannot be set, as rod\.radius is no table"):
        vp.Case.load("paper", {"rod.radius.x": 4})
