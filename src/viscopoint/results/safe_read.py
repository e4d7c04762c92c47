"""Files from others: regular ones, of a bounded size and inside their folder, or not read at all.

A run folder that came by mail may hold links to files elsewhere, pipes that nobody writes to, and tables nested
thousands deep. What is read here is data; nothing in it is called.
"""

import json
import os
import re
import stat
import tomllib
from pathlib import Path
from typing import Any

from viscopoint.messages import one_line

# A key of more parts than any of ours; to read one of n parts, Python's reader of TOML takes memory for n^2.
_PART = r"""(?:[A-Za-z0-9_-]++|"[^"\n]*+"|'[^'\n]*+')"""
LONG_KEY = re.compile(rf"(?:^|[\[{{,])[ \t]*+{_PART}(?:[ \t]*+\.[ \t]*+{_PART}){{50}}", re.M)
MOST_TABLES = 100_000  # ten thousand snapshots have as many
LARGEST_INTEGER, TOO_LARGE = 2**63, "an integer in it is too large"  # any that we write is smaller


def contents(path: Path, most: int) -> bytes:
    """Return what is in a regular file.

    Raises:
        OSError: it cannot be read.
        ValueError: it is no regular file, or holds more than ``most`` bytes; or its name can be none.
    """
    # without O_NONBLOCK a pipe would keep us waiting for somebody to write into it
    number = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0))
    with os.fdopen(number, "rb") as file:
        _check(os.fstat(number), most)
        data = file.read(most + 1)
    if len(data) > most:
        raise ValueError(_too_large(most))
    return data


def kept(folder: Path, name: str, most: int) -> Path:
    """Return the path of a file of a run folder, which may be opened then.

    Raises:
        OSError: there is none.
        ValueError: it is no regular file, a link that leads out of the folder, or larger than ``most`` bytes.
    """
    path = folder / name
    _check(path.stat(), most)
    if not is_inside(folder, name):
        raise ValueError("a link that leads out of the run folder")
    return path


def is_inside(folder: Path, name: str) -> bool:
    """Return whether a name is that of a file in a folder, and no link that leads out of it."""
    try:
        return Path(name).name == name and (folder / name).resolve().is_relative_to(folder.resolve())
    except (OSError, ValueError, RuntimeError):  # links in a circle; a null character
        return False


def toml(text: str) -> dict[str, Any]:
    """Return the tables that TOML holds.

    Raises:
        ValueError: it is not TOML, has an integer of more than the 64 bits that TOML speaks of, or is nested too deep.
    """
    if LONG_KEY.search(text):
        raise ValueError("a key in it has too many parts")
    try:
        tables = tomllib.loads(text)
    except RecursionError:
        raise ValueError("nested too deeply") from None
    except tomllib.TOMLDecodeError:
        raise
    except ValueError:  # Python reads no integer of more than 4300 digits
        raise ValueError(TOO_LARGE) from None
    todo: list[Any] = [tables]
    while todo:
        value = todo.pop()
        if isinstance(value, dict):
            todo += value.values()
        elif isinstance(value, list):
            todo += value
        elif isinstance(value, int) and abs(value) > LARGEST_INTEGER:
            raise ValueError(TOO_LARGE)
    return tables


def table(data: bytes) -> dict[str, Any]:
    """Return the table that JSON holds, of which all text shows as what it is.

    Raises:
        ValueError: it is not JSON, holds no table, too many or a number too large for us, or is nested too deeply.
    """
    if data.count(b"[") + data.count(b"{") > MOST_TABLES:
        raise ValueError(f"has more than {MOST_TABLES:,} tables and lists")
    try:
        found = _shown(json.loads(data.decode("utf-8"), parse_int=_integer))
    except RecursionError:
        raise ValueError("nested too deeply") from None
    if not isinstance(found, dict):
        raise ValueError("holds no table")
    return found


def _check(status: os.stat_result, most: int) -> None:
    if not stat.S_ISREG(status.st_mode):
        raise ValueError("not a regular file")
    if status.st_size > most:
        raise ValueError(_too_large(most))


def _too_large(most: int) -> str:
    return f"larger than {most:,} bytes"


def _integer(digits: str) -> int:
    if len(digits) > 20 or abs(int(digits)) > LARGEST_INTEGER:
        raise ValueError(TOO_LARGE)
    return int(digits)


def _shown(value: Any) -> Any:
    if isinstance(value, str):
        return one_line(value)
    if isinstance(value, list):
        return [_shown(entry) for entry in value]
    if isinstance(value, dict):
        return {one_line(key): _shown(entry) for key, entry in value.items()}
    return value
