"""`in_words`: a sentence with its parts called as on screens and sheets: from 1, or by name."""

import re

_NAMED = re.compile(r"\b(winch|marker)\[\d+\](?= )")
_POINT = re.compile(r"\bcable\[(\d+)\]\.points\[(\d+)\]")
_RUN = re.compile(r"\bcable\[(\d+)\] between points (\d+) and (\d+)")
_PART = re.compile(r"\b(pin|winch|cable|marker|pose)\[(\d+)\]")


def in_words(text: str) -> str:
    """Sentence in plain words: "cable 1, point 3" for "cable[0].points[2]", "winch left" for "winch[0] left"."""
    text = _POINT.sub(lambda match: f"cable {_next(match[1])}, point {_next(match[2])}", _NAMED.sub(r"\1", text))
    text = _RUN.sub(lambda run: f"cable {_next(run[1])} between points {_next(run[2])} and {_next(run[3])}", text)
    return _PART.sub(lambda match: f"{match[1]} {_next(match[2])}", text)


def _next(number: str) -> int:
    return int(number) + 1
