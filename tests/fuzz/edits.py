"""Damage that files come to, by accident or on purpose: of bytes, of words, of numbers, of what is nested."""

import re

from choices import Choices, chance, one_of

NUMBER = re.compile(rb"[+-]?\d+(?:\.\d*)?(?:e[+-]?\d+)?", re.I)
WORD = re.compile(rb"[A-Za-z_][A-Za-z_0-9.-]*")
NUMBERS = (
    b"0", b"-0.0", b"-1", b"1e-320", b"1e308", b"-1e308", b"1e999", b"nan", b"inf", b"-inf", b"NaN", b"Infinity",
    b"null", b"2147483648", b"9223372036854775807", b"9223372036854775808", b"-9223372036854775809",
    b"18446744073709551616", b"9" * 400, b"9" * 5000, b"0x" + b"f" * 6000, b"1" + b"0" * 30, b"3.8e-15", b"7e14",
    b"255", b"65536", b"true", b"[]",
)  # fmt: skip
TEXTS = (
    b"\x1b[2J\x1b]0;owned\x07", "\u202etxt.exe\u2066".encode(), b"<script>alert(1)</script>", b"$\\frac{1}{$",
    b"[bold red]", b":skull:", b"%s%n{0.__class__}", b"\x00", b"\\u0000", b"\\u001b[31m", b"\r\n", b"\x85",
    "\u2028\ufeff".encode(), b"\xff\xfe", b"../../../etc/passwd", b"/etc/passwd", b"a" * 300, b"x." * 400, b'"',
    b"'''", b'"""', b"\\", b"#", b"=", b",", b"\n", "µ٣Ⅷ".encode(), b"\xed\xa0\x80", b"\\ud800", b"[" * 3000,
    b'{"a":' * 2000, b"[[[[", b"]", b"}", b"{", b"1970-01-01", b"1979-05-27T07:32:00Z", b"07:32:00",
    b"__import__('os').system('true')", b"!!python/object:os.system",
)  # fmt: skip


def edited(choices: Choices, content: bytes, others: tuple[bytes, ...] = (), most: int = 4) -> bytes:
    """Return content with up to so many edits, or bytes of no shape at all; ``others`` are pieces to put in."""
    if chance(choices, 2):
        return choices.data(200)
    for _ in range(choices.integer(0, most)):
        content = one_of(choices, EDITS)(choices, content, others)
    return content


def _place(choices: Choices, content: bytes) -> int:
    return choices.integer(0, len(content))


def _cut(choices: Choices, content: bytes, others: tuple[bytes, ...]) -> bytes:
    return content[: _place(choices, content)]


def _without(choices: Choices, content: bytes, others: tuple[bytes, ...]) -> bytes:
    begin = _place(choices, content)
    return content[:begin] + content[begin + choices.integer(1, 1 + len(content) // 2) :]


def _repeated(choices: Choices, content: bytes, others: tuple[bytes, ...]) -> bytes:
    begin, times = _place(choices, content), one_of(choices, (1, 2, 50))
    piece = content[begin : begin + choices.integer(1, 64)]
    return content[:begin] + piece * times + content[begin:]


def _flipped(choices: Choices, content: bytes, others: tuple[bytes, ...]) -> bytes:
    if not content:
        return content
    begin = choices.integer(0, len(content) - 1)
    return content[:begin] + bytes([choices.integer(0, 255)]) + content[begin + 1 :]


def _overwritten(choices: Choices, content: bytes, others: tuple[bytes, ...]) -> bytes:
    begin = _place(choices, content)
    piece = choices.data(8)
    return content[:begin] + piece + content[begin + len(piece) :]


def _put_in(choices: Choices, content: bytes, others: tuple[bytes, ...]) -> bytes:
    begin = _place(choices, content)
    return content[:begin] + one_of(choices, (*TEXTS, *others)) + content[begin:]


def _number(choices: Choices, content: bytes, others: tuple[bytes, ...]) -> bytes:
    return _exchanged(choices, content, NUMBER, NUMBERS)


def _word(choices: Choices, content: bytes, others: tuple[bytes, ...]) -> bytes:
    return _exchanged(choices, content, WORD, (*TEXTS, *others, *NUMBERS))


def _line(choices: Choices, content: bytes, others: tuple[bytes, ...]) -> bytes:
    lines = content.splitlines(keepends=True)
    if not lines:
        return content
    one, other = (choices.integer(0, len(lines) - 1) for _ in range(2))
    action = choices.integer(0, 2)
    if action == 0:
        lines[one], lines[other] = lines[other], lines[one]
    elif action == 1:
        lines.insert(one, lines[other])
    else:
        del lines[one]
    return b"".join(lines)


def _exchanged(choices: Choices, content: bytes, pattern: re.Pattern[bytes], pieces: tuple[bytes, ...]) -> bytes:
    found = list(pattern.finditer(content))
    if not found:
        return content
    match = one_of(choices, found)
    return content[: match.start()] + one_of(choices, pieces) + content[match.end() :]


EDITS = (_number, _word, _put_in, _flipped, _overwritten, _line, _without, _repeated, _cut)
