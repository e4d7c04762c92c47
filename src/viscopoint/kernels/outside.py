"""Code outside the package that takes part: laws, and implementations of the package's operations, that users import.

The hash of the package's sources (``sources``) knows nothing of it. So what is compiled with it is not kept on the
disk, and a run that uses it records a hash of its files too.
"""

import ast
import functools
import hashlib
import importlib.util
import inspect
import secrets
import sys
import sysconfig
from collections.abc import Iterable, Iterator
from pathlib import Path
from types import ModuleType
from typing import Any, NamedTuple

PACKAGE = Path(__file__).resolve().parents[1]
LIBRARIES = {Path(sysconfig.get_path(name)).resolve() for name in ("stdlib", "platstdlib", "purelib", "platlib")}
UNKNOWN = secrets.token_hex(8)  # the hash of what is in no file: another one in each process


class Implementation(NamedTuple):
    """What somebody else's function does for a class in place of an operation of ours."""

    operation: Any
    subject: type
    function: Any


found: list[Implementation] = []  # from outside, as they were registered


def is_outside(code: Any) -> bool:
    """Return whether a class or function is none of the package's."""
    file = _file(inspect.getmodule(code))
    return file is None or not file.is_relative_to(PACKAGE)


def note(operation: Any, subject: type, function: Any) -> None:
    """Take note of an implementation if it is from outside."""
    if is_outside(function):
        found.append(Implementation(operation, subject, function))
        file = _file(inspect.getmodule(function))
        if file:
            _content(file)  # as it is loaded: who edits it later still runs this


def takes_part(types: Iterable[Any]) -> bool:
    """Return whether a kernel of these argument types (Numba's) runs code from outside.

    Its classes are among the types; or an implementation for one of our own classes was replaced, which any may use.
    """
    return any(not is_outside(one.subject) for one in found) or any(map(_has_outside, types))


def _has_outside(kind: Any) -> bool:
    subject = getattr(kind, "instance_class", None)
    if subject is not None and is_outside(subject):
        return True
    parts = getattr(kind, "types", ())
    return any(map(_has_outside, parts)) if isinstance(parts, tuple) else False


def hashed(classes: Iterable[type]) -> str:
    """Return a hash of the files from outside on which classes depend, and of those that replace what we bring.

    A file counts with those that it imports, but for libraries. Laws that the classes are not count for nothing. The
    hash is empty if there are no such files.
    """
    classes = [*classes]
    used = [one.function for one in found if one.subject in classes or not _of_a_law(one)]
    roots = {inspect.getmodule(code) for code in (*classes, *used) if is_outside(code)}
    if not roots:
        return ""
    parts = [_content(file) if file else UNKNOWN for file in _files(roots)]
    return hashlib.sha256("".join(sorted(parts)).encode()).hexdigest()[:16]


@functools.cache
def _content(file: Path) -> str:
    """Return a hash of a file as it was when this process first saw it."""
    return hashlib.sha256(file.read_bytes()).hexdigest()


def _of_a_law(one: Implementation) -> bool:
    """Return whether this belongs to a law from outside, and not to a shape function, or changes a law of ours."""
    return one.operation.__module__.startswith("viscopoint.materials") and is_outside(one.subject)


def _files(roots: set[ModuleType | None]) -> set[Path | None]:
    """Return the files of modules from outside and of all that they import; None stands for a module without."""
    own = {module.__name__.partition(".")[0] for module in roots if module}
    files: set[Path | None] = {_file(module) for module in roots}
    waiting = [module for module in roots if module]
    while waiting:
        for module in _imported(waiting.pop()):
            file = _file(module)
            library = any(file.is_relative_to(place) for place in (PACKAGE, *LIBRARIES)) if file else True
            if file not in files and (not library or module.__name__.partition(".")[0] in own):
                files.add(file)
                waiting.append(module)
    return files


def _imported(module: ModuleType) -> Iterator[ModuleType]:
    """Yield the modules that a module's file imports, as far as they are loaded."""
    file = _file(module)
    for node in ast.walk(ast.parse(file.read_bytes())) if file and file.suffix == ".py" else ():
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            base = "." * node.level + (node.module or "")
            name = importlib.util.resolve_name(base, module.__package__) if node.level else base
            names = [f"{name}.{alias.name}" for alias in node.names]
        else:
            continue
        for name in names:
            parts = name.split(".")
            yield from filter(None, (sys.modules.get(".".join(parts[:end])) for end in range(1, len(parts) + 1)))


@functools.cache
def _file(module: ModuleType | None) -> Path | None:
    name = getattr(module, "__file__", None)
    return Path(name).resolve() if name and Path(name).is_file() else None
