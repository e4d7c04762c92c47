"""A line that says what a case computes, made from its values, so that it is true whatever was changed."""

from typing import TYPE_CHECKING, Any

from viscopoint.case.units import Quantity

if TYPE_CHECKING:
    from viscopoint.case.case import Case
    from viscopoint.case.tables import Table


def description(case: "Case") -> str:
    """Return the physics and the method, such as "radius 3.8 mm, ...; fem, 0.38 mm"."""
    method = case.method
    flat = " axisymmetric" if method.geometry == "axisymmetric" else ""
    distance = f", {method.resolution():g} mm" if method.resolution() else ""
    return f"{physics(case)}; {method.name}{flat}{distance}"


def physics(case: "Case") -> str:
    """Return rod, impact and material."""
    what = ", ".join([*_values(case.rod), *_values(case.impact)])
    return f"{what}; {case.material.law}: {', '.join(_values(case.material))}"


def _values(table: "Table") -> list[str]:
    """Return the values of a table that are not those it has by default, with their names."""
    fields = type(table).model_fields
    return [
        f"{name.replace('_', ' ')} {_shown(value, fields[name].metadata)}"
        for name, value in table
        if value != fields[name].default and name != "law"
    ]


def _shown(value: Any, metadata: list[Any]) -> str:
    quantity = next((part for part in metadata if isinstance(part, Quantity)), None)
    if quantity:
        return quantity.shown(value)
    return f"{value:g}" if isinstance(value, float) else str(value)
