"""Changes of one line that some test must notice, over all that computes a number.

An entry has the file, the text and what to put in its place, and the few fast tests that are asked. Texts stand in
their file once, so that the list stays true as the code changes. A change that no test here notices wants a test of the
physics that it breaks, not an entry less.
"""

from typing import NamedTuple


class Mutation(NamedTuple):
    """One changed line."""

    name: str
    file: str  # in the package
    old: str
    new: str
    tests: str  # what pytest is given, from the folder of all tests


VISCOSITY, SOUND = "verification/test_bulk_viscosity.py", "verification/test_sound.py"
PATCH, CONSERVATION = "verification/test_fem_patch.py", "verification/test_fem_conservation.py"
ENERGY, ROTATION = "verification/test_material_energy.py", "verification/test_material_rotation.py"
RINGS, SIMILARITY = "verification/test_fem_rings.py", "verification/test_similarity.py"
CONTACT = "verification/test_contact_accounts.py"

MUTATIONS = [
    # --- bulk viscosity ---
    Mutation(
        "quadratic-viscosity-too-small", "model/viscosity.py",
        "- viscosity.quadratic * length * rate", "- 0.8 * viscosity.quadratic * length * rate",
        f"{VISCOSITY} -k 'steady_shock and fem-viscous'",
    ),
    Mutation(
        "linear-viscosity-too-small", "model/viscosity.py",
        "return viscosity.linear * sound - ", "return 0.9 * viscosity.linear * sound - ",
        f"{VISCOSITY} -k 'standing_wave and linear-fem-viscous'",
    ),
    Mutation(
        "one-point-viscous-work", "methods/fem/internal_force.py",
        "swept_before, swept_after = half * load(work, JACOBIAN, i)",
        "swept_before, swept_after = half * load(work, AFTER, i)",
        f"{VISCOSITY} -k 'viscous_loss and fem-viscous'",
    ),
    Mutation(
        "selective-viscous-work", "methods/fem/internal_force.py",
        "swept_before, swept_after = half * load(work, JACOBIAN, i)",
        "swept_before, swept_after = half * load(work, AFTER, i)",
        f"{VISCOSITY} -k 'viscous_loss and fem-selective'",
    ),
    Mutation(
        "one-point-ring-viscous-work", "methods/fem/internal_force.py",
        "swept_before, swept_after = half * load(work, JACOBIAN, i)",
        "swept_before, swept_after = half * load(work, AFTER, i)",
        f"{VISCOSITY} -k 'viscous_loss and rings-viscous'",
    ),
    Mutation(
        "selective-ring-viscous-work", "methods/fem/internal_force.py",
        "swept_before, swept_after = half * load(work, JACOBIAN, i)",
        "swept_before, swept_after = half * load(work, AFTER, i)",
        f"{VISCOSITY} -k 'viscous_loss and rings-selective'",
    ),
    Mutation(
        "points-viscous-work", "methods/mpm/stress.py",
        "swept_before, rate = load(work, JACOBIAN, i)", "swept_before, rate = 0.9 * load(work, JACOBIAN, i)",
        f"{VISCOSITY} -k 'standing_wave and linear-mpm-local'",
    ),
    Mutation(
        "points-viscosity-sees-another-length", "methods/mpm/stress.py",
        "viscosity, cell, rate, swept_before", "viscosity, 0.9 * cell, rate, swept_before",
        f"{VISCOSITY} -k 'standing_wave and quadratic-mpm-local'",
    ),
    Mutation(
        "reference-points-viscous-work-at-the-end", "methods/tlmpm/stress.py",
        "swept = 0.5 * load(work, MID_JACOBIAN, i)", "swept = 0.5 * load(work, AFTER, i)",
        f"{VISCOSITY} -k 'viscous_loss and tlmpm'",
    ),
    Mutation(
        "cell-mean-rate-of-the-undeformed-volume", "methods/tlmpm/volumes.py",
        "swept / middle", "swept / whole",
        f"{VISCOSITY} -k 'volume_that_the_law_sees and tlmpm'",
    ),
    # --- materials ---
    Mutation(
        "sudden-modulus-without-the-spring", "materials/linear_viscoelastic.py",
        "p_wave_modulus(self.bulk, self.shear_long + self.shear_maxwell)",
        "p_wave_modulus(self.bulk, self.shear_maxwell)",
        f"{SOUND} -k 'modulus'",
    ),
    Mutation(
        "dashpot-loss", "materials/linear_viscoelastic.py",
        "start, x * mean * mean,", "start, 0.99 * x * mean * mean,",
        ENERGY,
    ),
    Mutation(
        "return-without-hardening", "materials/plastic.py",
        "excess / (3.0 * shear_over_step(base, factors) + material.hardening)",
        "excess / (3.0 * shear_over_step(base, factors))",
        "verification/test_material_plasticity.py",
    ),
    Mutation(
        "elastic-shear-energy", "materials/elastic.py",
        "return 0.25 / material.shear", "return 0.24 / material.shear",
        ENERGY,
    ),
    Mutation(
        "hypoelastic-work", "materials/__init__.py",
        "return -0.5 * growth * (shear_energy", "return -0.45 * growth * (shear_energy",
        ENERGY,
    ),
    # --- kinematics ---
    Mutation(
        "strain-does-not-follow-the-rotation", "kernels/kinematics.py",
        "return strain + spun(strain, x, y, z), cayley(x, y, z)", "return strain, cayley(x, y, z)",
        ROTATION,
    ),
    Mutation(
        "rotation-too-small", "kernels/kinematics.py",
        "scale = 2.0 / (1.0 + x * x + y * y + z * z)", "scale = 1.99 / (1.0 + x * x + y * y + z * z)",
        ROTATION,
    ),
    # --- elements ---
    Mutation(
        "hourglass-damper-too-weak", "methods/fem/hourglass.py",
        "scaled(-16.0 * control.coefficient", "scaled(-15.0 * control.coefficient",
        f"{PATCH} -k 'viscous_control'",
    ),
    Mutation(
        "hourglass-spring-s-work", "methods/fem/hourglass.py",
        "scaled(0.5, increment)", "scaled(0.4, increment)",
        f"{PATCH} -k 'work_of_hourglass'",
    ),
    Mutation(
        "selective-pressure-of-the-undeformed-volume", "methods/fem/elements/selective.py",
        "load(work, MEAN, i) / load(work, REFERENCE, i)", "load(work, MEAN, i) / 1.0",
        f"{VISCOSITY} -k 'accounts and fem-selective'",
    ),
    Mutation(
        "selective-deviator-of-the-present-volume", "methods/fem/elements/selective.py",
        "load(work, POINT_REFERENCE, i) * load(work, AFTER, i) / det", "det / det",
        f"{VISCOSITY} -k 'accounts and rings-selective'",
    ),
    Mutation(
        "selective-mean-stress-of-equal-points", "methods/fem/elements/selective.py",
        "POINT_REFERENCE, i) * trace(stress)", "REFERENCE, i) * 0.125 * trace(stress)",
        "verification/test_stiffening.py -k 'mean_stress'",
    ),
    Mutation(
        "selective-step-of-points-of-their-own-volume", "methods/fem/elements/selective.py",
        "weights, counted / det)", "weights, 1.0 / det)",
        "verification/test_fem_elements.py -k 'most_squeezed'",
    ),
    Mutation(
        "ring-without-all-of-its-hoop", "methods/fem/cells/ring.py",
        "Vec(0.0, full * _area(a, b), 0.0),", "Vec(0.0, 0.99 * full * _area(a, b), 0.0),",
        f"{RINGS} -k 'patch'",
    ),
    Mutation(
        "ring-corner-mass", "methods/fem/section.py",
        "minlength=len(position)).astype(float)", "minlength=len(position)).mean() * np.ones(len(position))",
        f"{RINGS} -k 'breathes and selective'",
    ),
    Mutation(
        "nodes-of-equal-mass", "methods/fem/mesh.py",
        "minlength=len(position)).astype(float)", "minlength=len(position)).mean() * np.ones(len(position))",
        f"{CONSERVATION} -k 'just_the_energy and selective'",
    ),
    # --- contact ---
    Mutation(
        "friction-too-small", "interactions/rows.py",
        "row[FRICTION] * row[LAMBDA]", "0.9 * row[FRICTION] * row[LAMBDA]",
        f"{CONSERVATION} -k 'sliding and selective'",
    ),
    Mutation(
        "work-of-what-the-wall-stops", "interactions/rows.py",
        "along += force\n", "along += 0.5 * force\n",
        f"{CONTACT} -k 'nodes_lose'",
    ),
    Mutation(
        "piston-without-work", "interactions/rows.py",
        "            if row[TWO_SIDED] == 0.0:\n                along +=",
        "            if True:\n                along +=",
        "verification/test_pistons.py -k 'selective'",
    ),
    Mutation(
        "piston-that-forgets-what-grid-nodes-had", "interactions/rows.py",
        "+= 0.5 * force * slowed", "-= 0.5 * force * slowed",
        f"{CONTACT} -k 'holds_takes'",
    ),
    Mutation(
        "selective-step-of-the-last-point", "methods/fem/elements/selective.py",
        "max(load(work, STIFFEST, i), load(work, MODULUS, i))", "max(0.0, load(work, MODULUS, i))",
        "verification/test_stiffening.py -k 'selective'",
    ),
    Mutation(
        "foot-let-go-only-by-a-pull", "interactions/on_nodes.py",
        "    if force > 0.0:", "    if force > 1e-3:",
        f"{SIMILARITY} -k 'tlmpm-local'",
    ),
    Mutation(
        "mass-handed-up-at-another-speed", "interactions/on_nodes.py",
        "its + (m / both * apart) * normal", "its + (0.99 * m / both * apart) * normal",
        f"{CONTACT} -k 'momentum'",
    ),
    # --- points ---
    Mutation(
        "force-of-the-undeformed-volume", "methods/mpm/mapping.py",
        "size = points.shared.jacobian[p] * points.volume[p]", "size = points.volume[p]",
        "verification/test_mpm_manufactured.py -k 'lags and quadratic'",
    ),
    Mutation(
        "deviator-of-shared-dilatation", "methods/tlmpm/stress.py",
        "pull = (load(work, AFTER, i) / det_now) * deviator(stress)", "pull = deviator(stress)",
        "verification/test_tlmpm_patch.py -k 'do_the_work'",
    ),
    # --- what is measured ---
    Mutation(
        "energy-balance-s-remainder", "model/energy_balance.py",
        "numerical=start.energy - now.energy,", "numerical=start.energy - now.energy - now.viscous,",
        "verification/test_tlmpm_soft.py -k 'folds'",
    ),
    Mutation(
        "length-without-the-lattice-s-overhang", "model/measurements.py",
        "return last + overhang * (last - inner)", "return last + 0.9 * overhang * (last - inner)",
        "unit/test_body.py -k 'undeformed_rod'",
    ),
]  # fmt: skip
