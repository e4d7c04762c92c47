"""Variants of the material point method on problems with known answers: tables of docs/verification-of-variants.md.

Run it with one of ``discs``, ``bar``, ``rollers``, ``front`` or ``manufactured``. The problems are those of the tests.
"""

import sys
from collections.abc import Callable, Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any

import numba
import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "verification"))
import columns
import discs as collision
import lagrangian
import laplace
import test_mpm_manufactured
import test_schemes
import test_tlmpm_manufactured
from columns import DENSITY, LENGTH, Array, viscoelastic

from viscopoint.methods.mpm.shapes import SHAPES
from viscopoint.methods.mpm.transfers import Transfer
from viscopoint.methods.mpm.transfers.affine_pic import Apic, Tpic
from viscopoint.methods.mpm.transfers.flip import Flip
from viscopoint.methods.tlmpm.volumes import VOLUMES

ORDER = ("trilinear", "gimp", "cpgimp", "quadratic", "cubic")
TRANSFERS: dict[str, Transfer] = {
    "flip": Flip(0.0),
    "flip, 0.01 PIC": Flip(0.01),
    "PIC": Flip(1.0),
    "apic": Apic(),
    "tpic": Tpic(),
}
SPEED = 1e-4  # mm/ms: strains of 1e-7
CONFINED = (DENSITY, columns.BULK, columns.SHEAR_SHORT, columns.SHEAR_LONG)
Choices = dict[str, Any]


def variants(extras: bool) -> Iterator[tuple[str, Choices]]:
    """Give each name and its choices; ``extras`` beside shape functions and transfers."""
    assert set(ORDER) == set(SHAPES)
    for shape in ORDER:
        for name, transfer in TRANSFERS.items():
            if (shape, name) != ("trilinear", "tpic"):  # refused by cases
                yield f"{shape}, {name}", {"shape": shape, "transfer": transfer}
        yield f"{shape}, flip, cell-mean", {"shape": shape, "volume": "cell-mean"}
        if extras:
            yield f"{shape}, flip, gated", {"shape": shape, "contact": "gated"}


def row(*cells: str) -> None:
    print("|", " | ".join(cells), "|", flush=True)


def discs() -> None:
    row("variant", "first felt (ms)", "1 % lost (ms)", "least KE", "at (ms)", "KE at 3.6", "stored", "total lost (%)",
        "greatest gain (%)", "rebound")  # fmt: skip
    for name, choices in variants(extras=False):
        method = collision.discs(**choices)
        found = collision.collide(method)
        total = found.kinetic + found.stored
        least = int(found.kinetic.argmin())
        row(name, f"{found.felt:.3f}", f"{found.time[np.flatnonzero(found.kinetic < 0.99)[0]]:.3f}",
            f"{found.kinetic[least]:.4f}", f"{found.time[least]:.3f}", f"{found.kinetic[-1]:.3f}",
            f"{found.stored[-1]:.3f}", f"{100 * (1 - total[-1]):+.2f}", f"{100 * (total.max() - 1):.2f}",
            f"{collision.rebound(method):.3f}")  # fmt: skip


def bar() -> None:
    heads = ("elastic: frequency", "loss", "β = 65: frequency", "decay")
    row("variant", *(f"{head}, {cells} cells" for cells in (24, 48) for head in heads))
    for name, choices in [*variants(extras=False), *((f"tlmpm, {v}", {"of": v}) for v in VOLUMES)]:
        row(name, *(f"{value:+.1e}" for cells in (24, 48) for decay in (0.0, 65.0)
                    for value in ringing(cells, decay, choices)))  # fmt: skip


def ringing(cells: int, decay: float, choices: Choices) -> tuple[float, float]:
    """Return the relative errors of frequency and decay of a free column's fundamental mode (elastic: loss / w)."""
    solid = laplace.confined(*CONFINED, decay)
    k = np.pi / LENGTH
    square = (k * solid.speed) ** 2
    roots = np.roots([1.0, decay, square, square * solid.a])
    exact = complex(roots[roots.imag.argmax()])
    method, velocity = started(cells, viscoelastic(decay), (), lambda z: SPEED * np.cos(k * z), choices)
    mode = velocity() / SPEED
    dt, every, samples = method.stable_step(), cells // 6, list[float]()
    for _ in range(25):  # the start is left out: it is no state of transfers that keep a motion around points
        for _ in range(every):
            method.advance(dt)
        samples.append(float(velocity() @ mode / (mode @ mode)) / SPEED)
    found = test_schemes.modes(np.array(samples), every * dt, 3 if decay else 2)
    found = complex(found[found.imag.argmax()])
    lost = -found.real / exact.imag if not decay else found.real / exact.real - 1
    return found.imag / exact.imag - 1, lost


def rollers() -> None:
    meshes = (24, 48, 96)
    row("variant", *(f"{cells} cells" for cells in meshes))
    for name, choices in variants(extras=False):
        row(name, *(f"{held(cells, choices):+.1e}" for cells in meshes))


def held(cells: int, choices: Choices) -> float:
    """Return the relative error of the frequency of sin(kz) between rollers at both ends, elastic."""
    k, ends = np.pi / LENGTH, (columns.symmetry_plane(2, 0.0), columns.symmetry_plane(2, LENGTH))
    method = columns.column(cells, columns.ELASTIC, ends, lambda z: SPEED * np.sin(k * z), **choices)
    mode, dt, found = np.sin(k * columns.layers(method.body.position[:, 2])), method.stable_step(), list[float]()
    for _ in range(int(1.8 * cells / columns.COURANT)):
        method.advance(dt)
        found.append(float(columns.layers(method.points.velocity[:, 2]) @ mode))
    signs = np.array(found)
    at = np.flatnonzero(signs[1:] * signs[:-1] < 0)[:2]
    crossing = at + signs[at] / (signs[at] - signs[at + 1])
    return float(np.pi / (np.diff(crossing)[0] * dt) / (k * method.sound)) - 1


def started(
    cells: int, law: Any, ends: Any, speed: Callable[[Array], Array], choices: Choices
) -> tuple[Any, Callable[[], Array]]:
    """Return a column by either method, and what gives the velocity of its layers of points or planes of nodes."""
    if "of" in choices:
        lattice = lagrangian.column(cells, law, ends, lagrangian.upward(speed), choices["of"])
        return lattice, lambda: lagrangian.levels(lattice, lattice.nodes.velocity[:, 2])
    points = columns.column(cells, law, ends, speed, **choices)
    return points, lambda: columns.layers(points.points.velocity[:, 2])


def front() -> None:
    row("variant", *(f"β = {b}: {what}" for b in (0, 65) for what in ("velocity", "impulse", "front")))
    for name, choices in [*variants(extras=True), *((f"tlmpm, {v}", {"of": v}) for v in VOLUMES)]:
        row(name, *(text for decay in (0.0, 65.0) for text in wave(100, decay, 0.02, choices)))


def wave(cells: int, decay: float, time: float, choices: Choices) -> tuple[str, ...]:
    """Return the mean error of velocity, that of the impulse in rho v0 h, and how far the front is ahead in cells."""
    solid, h = laplace.confined(*CONFINED, decay), LENGTH / cells
    ends = columns.rigid_wall(0.0, 0.0)
    method, velocity = started(cells, viscoelastic(decay), (ends,), lambda z: np.full_like(z, -SPEED), choices)
    tl = "of" in choices
    x = lagrangian.levels(method, method.reference[:, 2]) if tl else columns.layers(method.body.position[:, 2])
    area = h**2 if tl else columns.area(method)
    columns.advance(method, time)
    gain = velocity() / SPEED + 1
    missed = float(np.abs(gain - 1 - laplace.velocity(solid, LENGTH, 1.0, x, time)).mean())
    pushed = float(method.totals().impulse[2]) / area - laplace.wall_impulse(solid, LENGTH, SPEED, time)
    half, place = solid.front(solid.speed * time) / 2, solid.speed * time
    i = np.flatnonzero(gain > half)[-1]
    ahead = x[i] + (gain[i] - half) / (gain[i] - gain[i + 1]) * (x[i + 1] - x[i]) - place
    return f"{missed:.4f}", f"{pushed / (DENSITY * SPEED * h):+.3f}", f"{ahead / h:+.2f}"


def manufactured() -> None:
    meshes, large, side = (8, 16, 32), test_tlmpm_manufactured.AMPLITUDE, test_tlmpm_manufactured.SIDE
    heads = (*(f"{n}³" for n in meshes), "orders")
    row("variant", *(f"{100 * np.pi * a / side:.1f} %: {head}" for a in (large / 3, large) for head in heads))
    for shape in ORDER:
        found = [[test_mpm_manufactured.error(n, shape, Flip(0.0), a) for n in meshes] for a in (large / 3, large)]
        row(shape, *(text for errors in found for text in (*(f"{e:.2e}" for e in errors), orders(errors))))
    for volume in VOLUMES:
        errors = [test_tlmpm_manufactured.error(n, volume) for n in meshes]
        row(f"tlmpm, {volume}", *("" for _ in range(4)), *(f"{e:.2e}" for e in errors), orders(errors))


def orders(errors: list[float]) -> str:
    return ", ".join(f"{np.log2(a / b):.2f}" for a, b in pairwise(errors))


if __name__ == "__main__":
    numba.set_num_threads(1)
    tables = {"discs": discs, "bar": bar, "rollers": rollers, "front": front, "manufactured": manufactured}
    tables[sys.argv[1]]()
