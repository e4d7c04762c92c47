"""A case: all that a simulation needs to know, read from TOML with units and checked as a whole."""

import tomllib
from collections.abc import Callable, Iterable, Iterator, Mapping
from importlib import resources
from pathlib import Path
from typing import Annotated, Any, Self, Union

import tomli_w
from pydantic import Field, ValidationError, model_validator
from pydantic_core import PydanticCustomError

import viscopoint.materials  # noqa: F401  (its modules declare the materials)
from viscopoint.arguments import checked
from viscopoint.case.explain import explain, valid_values
from viscopoint.case.rules import broken
from viscopoint.case.tables import Guards, Impact, MaterialInput, MethodInput, Output, Rod, Table, Time, Title
from viscopoint.errors import MOST_FAULTS, CaseError, Fault, InputError, nearest
from viscopoint.methods.fem.inputs import FEMInput
from viscopoint.methods.mpm.inputs import MPMInput
from viscopoint.methods.tlmpm.inputs import TotalLagrangianInput
from viscopoint.results.folder import CASE, PROVENANCE, is_file
from viscopoint.results.safe_read import contents, is_inside, toml

LONGEST_FILE = 1_000_000  # bytes
RECOMMENDED, RADIUS_IN_SPACINGS = "tlmpm", 10.0  # the method of a case that names none
SECONDARY = ("misfit", "default_factory_not_called")  # told by ``broken``; made by another fault
CHOICES = ("law", "name")  # keys that say what else is in their table
SHARED = {"bulk_viscosity", "geometry", "precision"}  # keys of [method] that another method takes over


def _materials(base: type[MaterialInput] = MaterialInput) -> Iterator[type[MaterialInput]]:
    """Yield the tables of all laws."""
    for derived in base.__subclasses__():
        if "law" in derived.model_fields:
            yield derived
        yield from _materials(derived)


METHODS: dict[str, type[MPMInput] | type[FEMInput] | type[TotalLagrangianInput]] = {
    "mpm": MPMInput,
    "fem": FEMInput,
    "tlmpm": TotalLagrangianInput,
}
AnyMethod = Annotated[MPMInput | FEMInput | TotalLagrangianInput, Field(discriminator="name")]
AnyMaterial = Annotated[Union[tuple(dict.fromkeys(_materials()))], Field(discriminator="law")]  # noqa: UP007


class Case(Table):
    """A rod, its impact, its material, the method and what to keep."""

    title: Title = ""
    rod: Rod
    impact: Impact
    material: AnyMaterial  # pyright: ignore[reportInvalidTypeForm]  (the laws found in the package)
    method: AnyMethod
    time: Time
    guards: Guards = Guards()
    output: Output = Output()

    @classmethod
    @checked
    def load(
        cls,
        source: str | Path,
        changes: Mapping[str, Any] | None = None,
        *,
        method: str | None = None,
        mend: Callable[[dict[str, Any]], dict[str, Any]] | None = None,
    ) -> Self:
        """Read a packaged case by its name, or a TOML file by its path.

        Args:
            source: such as "paper", or "my/case.toml".
            changes: values by dotted key, such as ``{"rod.radius": "4 mm"}``, put over those of the file, in any order.
                A table, such as ``{"method": {"name": "fem", "size": "0.5 mm"}}``, takes the place of the whole one.
            method: "mpm", "fem" or "tlmpm", to use in place of the case's own at the same distance of points or nodes.
            mend: puts the tables of an older file into present words.

        Raises:
            InputError: there is no such case, or it is not TOML.
            CaseError: the case has faults; the message lists them all.
        """
        try:
            tables = _with_base(_located(_read(source), Path(source)), str(source))
            tables = mend(tables) if mend else tables
            if method is not None:
                tables = tables | {"method": _replaced(cls.from_tables(tables, str(source)).method, method)}
            return cls.from_tables(_changed(tables, changes or {}), str(source))
        except RecursionError:
            raise InputError(f"{source}: tables nested too deeply; a case has at most three levels") from None

    @classmethod
    @checked
    def from_tables(cls, tables: Mapping[str, Any], source: str = "the case") -> Self:
        """Check tables as they stand in a TOML file; raise ``CaseError`` with all faults."""
        given, tables = tables, _with_method(tables)
        try:
            return cls.model_validate(dict(tables))
        except ValidationError as error:
            details = [detail for detail in error.errors(include_url=False) if detail["type"] not in SECONDARY]
            faults = [explain(detail, cls, tables) for detail in details[:MOST_FAULTS]]
            faults += broken(valid_values(cls, tables))
            more = max(len(details) - MOST_FAULTS, 0)
            raise CaseError(source, [_of_method(fault, given) for fault in faults], more) from None

    @checked
    def with_(self, changes: Mapping[str, Any] | None = None, /, **tables: Any) -> Self:
        """Return a changed copy, checked again.

        ``case.with_({"material.decay": "65 1/ms"})`` and ``case.with_(material={"decay": "65 1/ms"})`` do the same:
        named tables are put over those of the case key by key; ``changes`` are as ``load`` takes them.
        """
        return self.from_tables(_changed(merged(self.to_tables(), tables), changes or {}), "the changed case")

    def resolved(self) -> Self:
        """Return the case with what it leaves to be derived from other keys (the box, how often to write) spelt out."""
        method, output = self.method.completed(self.rod, self.impact, self.time), self.output.completed(self.time)
        return self.model_copy(update={"method": method, "output": output})

    def to_tables(self) -> dict[str, Any]:
        """Return the tables of a TOML file that gives this case, with defaults."""
        return self.model_dump(mode="json", exclude_none=True)

    def to_toml(self) -> str:
        """Return the text of a TOML file that gives this case."""
        return tomli_w.dumps(self.to_tables())

    @classmethod
    def file_schema(cls) -> dict[str, Any]:
        """Return the JSON schema of case files: nothing is required, since a file may extend a packaged case."""
        schema = cls.model_json_schema()
        schema["properties"]["extends"] = {
            "type": "string",
            "enum": list(packaged()),
            "description": "a packaged case over whose keys those of this file are put",
        }
        for table in (schema, *schema["$defs"].values()):
            table.pop("required", None)
            for key in table["properties"].values():
                if key.get("type") == "string" and not isinstance(key.get("default", ""), str):
                    key.pop("default")  # a number inside, text with a unit in the file
        return schema

    @model_validator(mode="after")
    def _fits_together(self) -> Self:
        for fault in broken(valid_values(type(self), self.to_tables())):
            raise PydanticCustomError("misfit", "{fault}", {"fault": str(fault)})
        return self


def packaged() -> dict[str, str]:
    """Return the packaged cases, name and title."""
    folder = resources.files("viscopoint.case.library")
    names = sorted(entry.name.removesuffix(".toml") for entry in folder.iterdir() if entry.name.endswith(".toml"))
    tables = {name: tomllib.loads((folder / f"{name}.toml").read_text()) for name in names}
    return {name: table.get("title") or tables[table["extends"]]["title"] for name, table in tables.items()}


def changes_of(settings: Iterable[str]) -> dict[str, Any]:
    """Return what texts such as ``rod.radius="4 mm"`` change, by dotted key: each value is TOML, or else bare text."""
    changes: dict[str, Any] = {}
    for setting in settings:
        key, equals, text = setting.partition("=")
        if not equals or not all(part.strip() for part in key.split(".")):
            raise InputError(f"--set {setting}: write it as KEY=VALUE, such as rod.radius='4 mm'")
        if key.strip() in changes:
            raise InputError(f"--set {setting}: {key.strip()} is set twice")
        try:
            changes[key.strip()] = toml(f"value = {text}")["value"]
        except (ValueError, KeyError):
            changes[key.strip()] = text.strip()
    return changes


def _changed(tables: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """Return tables with changes by dotted key: first whole tables, then laws and methods, then what is in them."""

    def place(change: tuple[str, Any]) -> tuple[int, bool]:
        steps = change[0].split(".")
        return (len(steps) if len(steps) > 1 else 0), steps[-1] not in CHOICES

    result = dict(tables)
    for key, value in sorted(changes.items(), key=place):
        chooses = key.rpartition(".")[2] in CHOICES
        result = merged(result, _nested(key, value)) if chooses else _with(result, key, value)
    return result


def _with(tables: Mapping[str, Any], key: str, value: Any, above: str = "") -> dict[str, Any]:
    """Return tables with a value at a dotted key, in place of what is there."""
    name, _, rest = key.partition(".")
    if rest:
        inner = tables.get(name, {})
        if not isinstance(inner, Mapping):
            raise InputError(f"{above}{key}: cannot be set, as {above}{name} is no table")
        value = _with(inner, rest, value, f"{above}{name}.")
    return {**tables, name: value}


def merged(tables: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """Return tables with changes put over them, key by key; a table of another law or method starts afresh."""
    result = dict(tables)
    for key, value in changes.items():
        old = result.get(key)
        if isinstance(old, Mapping) and isinstance(value, Mapping):
            chooses = any(choice in value and value[choice] != old.get(choice) for choice in CHOICES)
            result[key] = dict(value) if chooses else merged(old, value)
        else:
            result[key] = value
    return result


def _replaced(own: MethodInput, name: str) -> dict[str, Any]:
    """Return the table of another method with the resolution of a case's own."""
    if name not in METHODS:
        raise InputError(f"method '{name}' is not known; {nearest(name, METHODS)}")
    if isinstance(own, METHODS[name]):
        return own.model_dump(mode="json", exclude_none=True)
    if not own.resolution():
        raise InputError(f"method '{name}': the case's own takes its resolution from a file; write a [method] table")
    shared = own.model_dump(mode="json", include=SHARED & METHODS[name].model_fields.keys())
    return METHODS[name].at_resolution(own.resolution()) | shared


def _with_method(tables: Mapping[str, Any]) -> Mapping[str, Any]:
    """Return tables with the recommended method, if they name none, at its usual spacing, if they give none."""
    own, rod = tables.get("method", {}), tables.get("rod")
    if not isinstance(own, Mapping) or own.get("name", RECOMMENDED) != RECOMMENDED:
        return tables
    radius = valid_values(Rod, rod).get("radius", 1.0) if isinstance(rod, Mapping) else 1.0  # of any: told elsewhere
    return {**tables, "method": {"name": RECOMMENDED, "spacing": f"{radius / RADIUS_IN_SPACINGS!r} mm", **own}}


def _of_method(fault: Fault, given: Mapping[str, Any]) -> Fault:
    """Return a fault that says which method was meant, if the case names none."""
    if not fault.key.startswith("method.") or _at_key(given, "method", "name") is not None:
        return fault
    return fault._replace(message=f'{fault.message} (the case names no method: method.name is "{RECOMMENDED}")')


def _located(tables: dict[str, Any], source: Path) -> dict[str, Any]:
    """Return the tables with file names that are meant from the case file's folder."""
    mesh = _at_key(tables, "method", "mesh")
    if not isinstance(mesh, str):
        return tables
    if source.name == CASE and is_file(source.with_name(PROVENANCE)) and not is_inside(source.parent, mesh):
        told = "leads out of the run folder, which keeps its mesh; write the name of a file in it"
        raise CaseError(str(source), [Fault("method.mesh", f'"{mesh}" {told}')])
    return merged(tables, _nested("method.mesh", str(source.parent / mesh)))


def _at_key(tables: Any, *keys: str) -> Any:
    for key in keys:
        tables = tables.get(key) if isinstance(tables, Mapping) else None
    return tables


def _nested(key: str, value: Any) -> dict[str, Any]:
    """Return {"a": {"b": value}} for the key "a.b"."""
    for name in reversed(key.split(".")):
        value = {name: value}
    return value


def _read(source: str | Path) -> dict[str, Any]:
    path = Path(source)
    if path.suffix != ".toml" and not is_file(path):
        names = packaged()
        if str(source) not in names:
            raise InputError(f"there is no case '{source}', neither packaged nor a file; {nearest(str(source), names)}")
        return tomllib.loads((resources.files("viscopoint.case.library") / f"{source}.toml").read_text())
    try:
        text = contents(path, LONGEST_FILE)
    except (OSError, ValueError) as error:
        raise InputError(f"case file {path}: cannot be read ({getattr(error, 'strerror', error)})") from None
    try:
        return toml(text.decode("utf-8-sig"))
    except ValueError as error:
        raise InputError(f"case file {path}: not TOML ({error})") from None


def _with_base(tables: dict[str, Any], source: str) -> dict[str, Any]:
    """Put the tables over those of the packaged case that they extend."""
    if "extends" not in tables:
        return tables
    names = packaged()
    base = tables["extends"]
    if not isinstance(base, str) or base not in names:
        raise CaseError(source, [Fault("extends", f"{base!r} is no packaged case; {nearest(str(base), names)}")])
    rest = {key: value for key, value in tables.items() if key != "extends"}
    return merged(_with_base(_read(base), base), rest)
