"""A material as machine code of its own, which kernels call for a block of points by its address.

So kernels know nothing of materials: they are compiled once for all of them, and another material compiles three short
functions. What goes in and comes out stands in the columns of the workspace that are named here; a method's own columns
begin at ``OWN``. The parameters, and what is computed of them once for a step, are a row of numbers.
"""

import ctypes
import functools
import hashlib
import itertools
from typing import Any, NamedTuple

import numpy as np
from llvmlite import ir
from numba import typeof, types
from numba.core.ccallback import CFunc
from numba.extending import intrinsic, overload

from viscopoint import materials
from viscopoint.kernels import outside
from viscopoint.kernels.arrays import Array, Real
from viscopoint.kernels.cache import Cache, words
from viscopoint.kernels.jit import INLINED, OPTIONS, check_implemented, inline
from viscopoint.kernels.kinematics import deformed, strain_and_rotation
from viscopoint.kernels.packing import numbers_of, size, value_of
from viscopoint.kernels.pipeline import Whole
from viscopoint.kernels.tensors import IDENTITY, Matrix, deviator, spherical
from viscopoint.kernels.workspace import (
    HISTORY,
    WORKSPACE,
    add,
    columns,
    load,
    load_matrix,
    load_sym,
    load_tuple,
    store,
)
from viscopoint.materials import HistoryField, Increment, Material

(
    STRESS,  # Cauchy, MPa
    GRADIENT,  # ∂Δu/∂x of the step, at mid-step
    SWEPT,  # tr Δε that the point shall have, its own or one that it shares
    JACOBIAN,  # J at the start of the step
    AFTER,  # J at its end
    DISSIPATED,  # by the material, per reference volume, since the start, mJ/mm^3
    HYPOELASTIC,  # taken as volume changes under shear, likewise
    MODULUS,  # K + 4G/3 now, MPa
    OWN,
) = columns(6, 9, *(1,) * 6)
STORED = SWEPT  # energy per reference volume, mJ/mm^3, where the block of energies leaves it
DEFORMATION_GRADIENT = HistoryField("deformation_gradient", "1", 9, np.eye(3).ravel().tolist())
NUMBERS = types.CPointer(types.float64)
OPERATIONS = (materials.step_factors, materials.update_stress, materials.stored_energy, materials.shear_energy)
FIRST = 1  # of ``numbers``, after Δt


class MaterialCode(NamedTuple):
    """What kernels are handed of any material."""

    update: int  # address of the block that advances points by a step
    energies: int  # of that which finds their stored energy
    numbers: Array  # Δt, parameters, and what is computed of them for the step
    density: float  # g/mm^3
    n_history: int  # values of a point


class MaterialBlock:
    """A material, compiled."""

    def __init__(self, material: Material) -> None:
        for operation in OPERATIONS:
            check_implemented(operation, material)
        self.material = material
        own = (DEFORMATION_GRADIENT,) if _needs_deformation(material) else ()
        self.history_fields: tuple[HistoryField, ...] = (*own, *material.history_fields)
        factors = materials.step_factors(material, 1.0)
        numbers = np.array([1.0, *_flat(material), *_flat(factors)])
        blocks = _compiled(typeof(_zero(material)), typeof(_zero(factors)), self.n_own, bool(own))
        self._prepare = blocks.prepare.ctypes
        self._numbers = numbers.ctypes.data_as(ctypes.POINTER(ctypes.c_double))
        n_history = len(self.initial_history())
        addresses = blocks.update.address, blocks.energies.address
        self.code = MaterialCode(*addresses, numbers, float(material.density), n_history)

    @property
    def n_own(self) -> int:
        """Number of history values that the material itself knows of a point."""
        return sum(field.components for field in self.material.history_fields)

    def of_step(self, dt: float) -> MaterialCode:
        """Return what kernels are handed for a step ``dt`` [ms]."""
        self.code.numbers[0] = dt
        self._prepare(self._numbers)
        return self.code

    def initial_history(self) -> list[float]:
        """Return a point's history values at the start."""
        return [
            float(value) for field in self.history_fields for value in np.broadcast_to(field.initial, field.components)
        ]

    def history(self, count: int, real: Real = np.float64) -> Array:
        """Return the history ``[point, value]`` of points at the start."""
        return np.tile(np.array(self.initial_history(), real), (count, 1))


def call_block(address: int, work: Any, count: int, numbers: Array) -> None:
    """Call a material's block for the first ``count`` points of the workspace."""
    raise NotImplementedError


@intrinsic
def _call(context: Any, address: Any, work: Any, count: Any, numbers: Any) -> Any:
    def lower(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        real = ir.DoubleType().as_pointer()
        kind = ir.FunctionType(ir.VoidType(), [real, ir.IntType(64), real])
        array = context.make_array(signature.args[3])(context, builder, values[3])
        builder.call(builder.inttoptr(values[0], kind.as_pointer()), [values[1], values[2], array.data])
        return context.get_dummy_value()

    return types.none(types.int64, work, types.int64, numbers), lower


@overload(call_block, strict=False, jit_options=INLINED)
def _call_it(address: Any, work: Any, count: Any, numbers: Any) -> Any:
    return lambda address, work, count, numbers: _call(address, work, count, numbers)  # pyright: ignore[reportCallIssue]


def _needs_deformation(part: Any) -> bool:
    """Return whether a material, or a part of it, asks for F."""
    inner = part if isinstance(part, tuple) else ()
    return bool(getattr(part, "needs_deformation", False)) or any(map(_needs_deformation, inner))


# --- how a block is made ---


class _Blocks(NamedTuple):
    prepare: Any
    update: Any
    energies: Any


@functools.cache
def _compiled(material: Any, factors: Any, n_own: int, with_deformation: bool) -> _Blocks:
    """Return the three functions of a material and its step factors, given by Numba's types."""
    material_in, factors_in = _reader(material, FIRST), _reader(factors, FIRST + size(material))
    put_factors = _writer(FIRST + size(material))
    like, own = (0.0,) * n_own, HISTORY + (9 if with_deformation else 0)

    def prepare(numbers: Any) -> None:
        put_factors(numbers, materials.step_factors(material_in(numbers), numbers[0]))

    # parameters are read before the loop, as the compiler cannot know that a block's results do not change them

    def update(work: Any, count: int, numbers: Any) -> None:
        parameters, of_step, dt = material_in(numbers), factors_in(numbers), numbers[0]
        for i in range(count):
            advance_point(work, i, parameters, of_step, dt, IDENTITY, own, like)

    def update_with_deformation(work: Any, count: int, numbers: Any) -> None:
        parameters, of_step, dt = material_in(numbers), factors_in(numbers), numbers[0]
        for i in range(count):
            deformation = deformed(load_matrix(work, HISTORY, i), load_matrix(work, GRADIENT, i), load(work, AFTER, i))
            store(work, HISTORY, i, deformation)
            advance_point(work, i, parameters, of_step, dt, deformation, own, like)

    def energies(work: Any, count: int, numbers: Any) -> None:
        parameters = material_in(numbers)
        for i in range(count):
            history = load_tuple(work, own, i, like)
            stored = materials.stored_energy(parameters, load(work, JACOBIAN, i), load_sym(work, STRESS, i), history)
            store(work, STORED, i, stored)

    block = types.void(WORKSPACE, types.intp, NUMBERS)
    shape = f"{words(material)}, {words(factors)}, {n_own}, {with_deformation}"  # classes may share a name
    own_name = f"{_classes(material)}_{hashlib.sha256(shape.encode()).hexdigest()[:8]}"
    return _Blocks(
        _function(prepare, types.void(NUMBERS), material, own_name),
        _function(update_with_deformation if with_deformation else update, block, material, own_name),
        _function(energies, block, material, own_name),
    )


@inline
def advance_point(
    work: Any, i: int, material: Any, factors: Any, dt: float, deformation: Matrix, own: int, like: Any
) -> None:
    """Advance point i of the block by a step: stress, history and energies. J stays that of the step's start."""
    before, after = load(work, JACOBIAN, i), load(work, AFTER, i)
    stress, history = load_sym(work, STRESS, i), load_tuple(work, own, i, like)
    strain, rotation = strain_and_rotation(load_matrix(work, GRADIENT, i))
    strain = deviator(strain) + spherical(load(work, SWEPT, i) / 3.0)
    increment = Increment(dt, strain, rotation, after, deformation)
    now = materials.update_stress(material, factors, increment, stress, history)
    taken = materials.hypoelastic_work(material, after - before, stress, history, now.stress, now.history)
    store(work, STRESS, i, now.stress)
    store(work, own, i, now.history)
    add(work, DISSIPATED, i, 0.5 * (before + after) * now.dissipated)
    add(work, HYPOELASTIC, i, taken)
    store(work, MODULUS, i, now.p_wave_modulus)


def _function(code: Any, signature: Any, material: Any, name: str) -> CFunc:
    """Return a compiled function of C's calling convention, from the disk if it is there."""
    name = "".join(letter if letter.isalnum() else "_" for letter in name)
    code.__qualname__ = code.__name__ = f"{code.__name__}_{name}"  # in the process, and on the disk
    made: Any = CFunc(code, (signature.args, signature.return_type), {}, OPTIONS, Whole)
    made._cache = Cache(code, outside.takes_part([material]))
    made.compile()
    return made


def _classes(kind: Any) -> str:
    """Return the names of a material's classes, from outside in."""
    parts = [_classes(part) for part in kind.types if hasattr(part, "instance_class")]
    return f"{kind.instance_class.__name__}({', '.join(parts)})"


def _flat(value: Any) -> list[float]:
    return [number for part in value for number in _flat(part)] if isinstance(value, tuple) else [float(value)]


def _zero(value: Any) -> Any:
    """Return a value of the same classes, all numbers floats."""
    if not isinstance(value, tuple):
        return 0.0
    parts = map(_zero, value)
    return type(value)(*parts) if hasattr(value, "_fields") else tuple(parts)


def _reader(kind: Any, first: int) -> Any:
    """Return a function of ``numbers`` that makes a value of one of Numba's types of those from ``first`` on."""

    @intrinsic
    def read_value(context: Any, numbers: Any) -> Any:
        def lower(context: Any, builder: Any, signature: Any, values: Any) -> Any:
            loaded = (builder.load(_place(builder, values[0], place)) for place in itertools.count(first))
            return value_of(context, builder, kind, loaded)

        return kind(numbers), lower

    return read_value


def _writer(first: int) -> Any:
    """Return a function that puts a value into ``numbers`` from ``first`` on."""

    @intrinsic
    def write_value(context: Any, numbers: Any, value: Any) -> Any:
        def lower(context: Any, builder: Any, signature: Any, values: Any) -> Any:
            for place, number in enumerate(numbers_of(context, builder, signature.args[1], values[1]), first):
                builder.store(number, _place(builder, values[0], place))
            return context.get_dummy_value()

        return types.none(numbers, value), lower

    return write_value


def _place(builder: Any, numbers: Any, place: int) -> Any:
    return builder.gep(numbers, [ir.Constant(ir.IntType(64), place)], inbounds=True)
