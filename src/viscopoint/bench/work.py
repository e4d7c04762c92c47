"""What is measured: methods, shape functions or elements, laws, and problem sizes of the paper's rod."""

from collections.abc import Sequence
from itertools import product
from typing import Any, NamedTuple

from viscopoint.bench.traffic import PASSES, Pass
from viscopoint.case.case import Case
from viscopoint.methods.fem.elements import ELEMENTS
from viscopoint.methods.mpm.shapes import SHAPES
from viscopoint.methods.tlmpm.inputs import NODAL


class Size(NamedTuple):
    """A resolution of the paper's rod."""

    spacing: float  # of points, mm
    element: float  # edge of elements, of which there are about as many as MPM has points, mm


SIZES = {
    "3k": Size(0.76, 0.82),
    "21k": Size(0.38, 0.405),
    "169k": Size(0.19, 0.1975),
    "1.35M": Size(0.095, 0.0975),
}
EXTENTS = {"tiny": ("3k",), "small": ("21k",), "medium": ("21k", "169k"), "large": ("21k", "169k", "1.35M")}
GROWTH_SIZE = "169k"  # at which a process is watched as it grows
PAPER_GRID = 0.5 / 0.38  # spacings to a cell of MPM

Variant = tuple[str, str]  # method; shape function or element
VARIANTS: tuple[Variant, ...] = (
    *product(("mpm",), SHAPES),
    *product(("tlmpm",), NODAL),
    *product(("fem",), ELEMENTS),
)
USUAL: tuple[Variant, ...] = (("mpm", "trilinear"), ("tlmpm", "trilinear"), ("fem", "one-point"))
HEADLINE: tuple[Variant, ...] = (*USUAL, ("mpm", "quadratic"), ("fem", "selective"))

PAPER_LAW = "linear-viscoelastic"
_PAPER = {"density": "1 g/cm^3", "bulk": "550 MPa"}
_ARM = {"shear_short": "140 MPa", "shear_long": "5 MPa", "decay": "650 1/ms"}
_YIELDING = {"yield_stress": "20 MPa", "hardening": "10 MPa"}  # of no material: low, so that points do yield
MATERIALS: dict[str, dict[str, str]] = {  # the paper's moduli; laws that have none here are not measured
    PAPER_LAW: _PAPER | _ARM,
    "elastic": _PAPER | {"shear": "140 MPa"},
    "elastic-plastic": _PAPER | {"shear": "140 MPa"} | _YIELDING,
    "linear-viscoelastic-plastic": _PAPER | _ARM | _YIELDING,
}


class Work(NamedTuple):
    """One thing to measure."""

    method: str
    variant: str  # shape function or element
    law: str
    size: str  # one of ``SIZES``

    @property
    def name(self) -> str:
        """Return how it is called on the terminal."""
        return " ".join(self)


def selection(sizes: Sequence[str], quick: bool) -> tuple[Work, ...]:
    """Return all works of some sizes, the smallest first."""
    first, larger = sizes[:1], sizes[1:]
    table: tuple[tuple[Sequence[str], Sequence[Variant], Sequence[str]], ...] = (
        # sizes, variants, laws: each with each
        (first, VARIANTS, (PAPER_LAW,)),
        (first, USUAL, () if quick else tuple(MATERIALS)),
        (larger, HEADLINE, (PAPER_LAW,)),
    )
    return tuple(
        dict.fromkeys(
            Work(*variant, law, size)
            for sizes, variants, laws in table
            for size, variant, law in product(sizes, variants, laws)
        )
    )


def case_of(work: Work) -> Case:
    """Return the paper's case with method, law and size of a work."""
    size = SIZES[work.size]
    tables: dict[str, dict[str, Any]] = {
        "mpm": {"spacing": f"{size.spacing!r} mm", "cell": f"{PAPER_GRID * size.spacing!r} mm", "shape": work.variant},
        "tlmpm": {"spacing": f"{size.spacing!r} mm", "shape": work.variant},
        "fem": {"size": f"{size.element!r} mm", "element": work.variant},
    }
    material = {"law": work.law, **MATERIALS[work.law]}
    return Case.load("paper").with_(method={"name": work.method, **tables[work.method]}, material=material)


def passes_of(work: Work) -> tuple[Pass, ...]:
    """Return the passes of a work's step over memory."""
    return PASSES[f"fem, {work.variant}" if work.method == "fem" else work.method]
