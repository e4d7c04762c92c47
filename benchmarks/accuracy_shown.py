"""The tables and figures of docs/accuracy.md, from the runs that accuracy.py made."""

import csv
import itertools
import json
import math
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from accuracy import CASES, FOLDER, SPACINGS, USUAL, VARIANTS, Errors, errors, processor_time
from convergence import table
from matplotlib.figure import Figure

FIGURES, ALL = Path("docs", "figures"), Path("docs", "accuracy.csv")
UNITS = dict.fromkeys(Errors._fields, "%") | {"noise": "MPa"}
Everything = Mapping[tuple[str, str, float], Mapping[str, Errors]]


def mean_error(found: Errors) -> float:
    """Return the mean size of the five errors that a user asks for first [%]."""
    return float(np.mean(np.abs(found[:5])))


def show_all() -> None:
    """Print the tables and draw the figures."""
    everything = {
        (name, key, spacing): errors(name, key, spacing)
        for name, key, spacing in itertools.product(CASES, VARIANTS, SPACINGS)
        if (FOLDER / f"{name}-{key}-{spacing}").exists()
    }
    write_all(everything)
    for moment in ("20 us", "60 us"):
        print(f"### {moment}, spacing {USUAL} mm\n")
        at_usual(everything, moment)
    print("### Orders\n")
    orders(everything)
    print("### Cost\n")
    costs(everything)
    FIGURES.mkdir(exist_ok=True)
    convergence(everything).savefig(FIGURES / "convergence.png", dpi=110)
    pareto(everything).savefig(FIGURES / "pareto.png", dpi=110)


def write_all(everything: Everything) -> None:
    """Write every error at every spacing and time."""
    with ALL.open("w", newline="") as file:
        lines = csv.writer(file, lineterminator="\n")
        lines.writerow(
            ("case", "method", "spacing [mm]", "time", *(f"{name} [{UNITS[name]}]" for name in Errors._fields))
        )
        for (name, key, spacing), found in everything.items():
            for moment, one in found.items():
                lines.writerow((name, key, spacing, moment, *(f"{value:.4g}" for value in one)))


def at_usual(everything: Everything, moment: str) -> None:
    """Print all errors at one time."""
    head = (
        "case", "method", "foot radius", "greatest radius", "velocity", "kinetic", "impulse", "length", "outline",
        "noise (MPa)", "energy error",
    )  # fmt: skip
    rows = []
    for name, (key, variant) in itertools.product(CASES, VARIANTS.items()):
        found = everything[name, key, USUAL].get(moment)
        if found is None:
            rows.append([CASES[name], variant.label, "stopped", *[""] * 8])
            continue
        shown = [f"{value:+.2f}" for value in found[:6]]
        if moment == "20 us":
            shown[5] = "-"  # the fastest wave has not been at the tail
        rows.append([CASES[name], variant.label, *shown, f"{found.outline:.2f}", f"{found.noise:.1f}",
                     f"{found.energy_error:.2f}"])  # fmt: skip
    table(head, rows)


def orders(everything: Everything) -> None:
    """Print the mean error at 20 µs at each spacing, and the observed order between the finest two."""
    rows = []
    for key, variant in VARIANTS.items():
        cells = []
        for name in CASES:
            found = [everything.get((name, key, spacing), {}).get("20 us") for spacing in SPACINGS]
            means = [mean_error(one) for one in found if one is not None]
            order = math.log(means[-2] / means[-1]) / math.log(2.0) if len(means) > 1 else math.nan
            cells.append(", ".join(f"{mean:.2f}" for mean in means) + f" ({order:.1f})")
        rows.append([variant.label, *cells])
    table(("method", *CASES.values()), rows)


def costs(everything: Everything) -> None:
    """Print what a step and a run cost, relative to the paper's method."""
    measured = json.loads((FOLDER / "cost.json").read_text())
    rows = []
    for key, variant in VARIANTS.items():
        step = measured[f"{key}-{USUAL}"] / measured[f"paper-{USUAL}"]
        run = processor_time("paper", key, USUAL, "20 us") / processor_time("paper", "paper", USUAL, "20 us")
        mean = np.mean([mean_error(everything[name, key, USUAL]["20 us"]) for name in CASES])
        rows.append([variant.label, f"{step:.2f}", f"{run:.2f}", f"{mean:.2f}"])
    table(("method", "a step, relative", "a run to 20 us, relative", "mean error, four materials (%)"), rows)


DRAWN = {
    "paper": "#d55e00", "trilinear-8": "#e69f00", "gimp": "#56b4e9", "gimp-apic": "#0072b2",
    "quadratic-apic": "#cc79a7", "tlmpm": "#000000", "fem": "#009e73", "fem-selective": "#7f7f7f",
}  # fmt: skip


def convergence(everything: Everything) -> Figure:
    """Draw the size of each error at 20 µs over the spacing, for each material."""
    quantities = ("impact_face_radius", "velocity", "kinetic", "wall_impulse", "outline")
    figure = Figure(figsize=(13.0, 11.0), layout="constrained")
    axes = figure.subplots(len(CASES), len(quantities), sharex=True)
    for (name, label), line in zip(CASES.items(), axes, strict=True):
        for quantity, axis in zip(quantities, line, strict=True):
            for key, colour in DRAWN.items():
                points = [
                    (spacing, abs(getattr(everything[name, key, spacing]["20 us"], quantity)))
                    for spacing in SPACINGS
                    if "20 us" in everything.get((name, key, spacing), {})
                ]
                axis.loglog(*zip(*points, strict=True), "o-", color=colour, label=VARIANTS[key].label, markersize=3)
            axis.loglog(SPACINGS, [0.05 * spacing / SPACINGS[-1] for spacing in SPACINGS], ":", color="0.6")
            axis.set(title=f"{label}: {quantity.replace('_', ' ')}", ylim=(1e-3, 30.0))
            axis.set_xticks(SPACINGS, [f"{spacing:g}" for spacing in SPACINGS])
            axis.minorticks_off()
    for axis in axes[-1]:
        axis.set_xlabel("spacing (mm)")
    for line in axes:
        line[0].set_ylabel("error (%)")
    figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside upper center", ncols=4)
    return figure


def pareto(everything: Everything) -> Figure:
    """Draw the mean error of the four materials at 20 µs over the processor time."""
    figure = Figure(figsize=(9.0, 6.0), layout="constrained")
    axis = figure.subplots()
    for key, variant in VARIANTS.items():
        points = []
        for spacing in SPACINGS:
            found = [everything.get((name, key, spacing), {}).get("20 us") for name in CASES]
            if all(one is not None for one in found):
                mean = float(np.mean([mean_error(one) for one in found if one is not None]))
                points.append((np.mean([processor_time(name, key, spacing, "20 us") for name in CASES]), mean))
        if key in DRAWN:
            axis.loglog(*zip(*points, strict=True), "o-", color=DRAWN[key], label=variant.label)
        else:
            axis.loglog(*zip(*points, strict=True), "s--", color="0.75", markersize=3)
            axis.annotate(key, points[-1], fontsize=6, color="0.5", xytext=(3, 3), textcoords="offset points")
    axis.set_xlabel("processor time to 20 µs, one core (s)")
    axis.set_ylabel("mean error of radii, velocity, energy, impulse (%)")
    axis.legend(fontsize=8)
    axis.grid(which="both", alpha=0.2)
    return figure


if __name__ == "__main__":
    show_all()
