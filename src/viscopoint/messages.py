"""Text from others on a terminal or a page: it shows as what it is and acts on nothing.

A title or the name of a key may hold what moves a terminal's cursor, sets its colours or its window's title, or turns
the direction of what follows. In messages such characters are shown by their escapes.
"""

import itertools
import unicodedata

LONGEST_LINE = 2000  # characters of a line in a message; of a longer one the middle is left out
MOST_LINES = 200
TAIL = 400  # characters of a line too long that are kept of its end, which often says what is allowed
JOINERS = "\u200c\u200d"  # Persian and Indian words need them, and emoji


def unseen(text: str) -> str | None:
    """Return the first character that does not show as itself, but acts on what is around it; None if there is none.

    These are control characters, separators of lines and paragraphs, and what sets the direction of text.
    """
    return next((letter for letter in text if _acts(letter)), None)


def one_line(text: str) -> str:
    """Return text on one line, with escapes in place of what does not show as itself."""
    if text.isprintable():
        return text
    return "".join(letter.encode("unicode_escape").decode("ascii") if _acts(letter) else letter for letter in text)


def message(text: str) -> str:
    """Return a message's lines, each as ``one_line`` and neither too many nor too long."""
    lines = text.split("\n")
    if len(lines) > MOST_LINES:
        lines = [*itertools.islice(lines, MOST_LINES), f"and {len(lines) - MOST_LINES} lines more"]
    return "\n".join(one_line(clipped(line)) for line in lines)


def clipped(line: str, most: int = LONGEST_LINE) -> str:
    """Return a line without its middle, if it is too long."""
    tail = min(TAIL, most // 3)
    return line if len(line) <= most else f"{line[: most - tail]} ... {line[-tail:]}"


def _acts(letter: str) -> bool:
    return unicodedata.category(letter) in ("Cc", "Cf", "Cs", "Zl", "Zp") and letter not in JOINERS
