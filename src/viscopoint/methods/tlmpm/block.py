"""What a block of points has in the workspace while they are strained, beside what they carry."""

from viscopoint.kernels.workspace import columns
from viscopoint.model.points import OWN

NINE = (0.0,) * 9
(
    STEP,  # F_n+1 - F_n; then the force on the areas, -V_p P_p
    DEFORMATION,  # F
    STRAIN,  # increment
    TURN,  # Q
    VOLUME,  # V_p
    DETERMINANT,  # det F at the end of the step
    MID_JACOBIAN,  # det F at mid-step
    SWELLING,  # tr Δε
    AFTER,  # J that the law shall see at the end of the step
    STEP_LENGTH,  # the longest stable step
    _,
) = columns(9, 9, 6, 9, *(1,) * 6, first=OWN)
