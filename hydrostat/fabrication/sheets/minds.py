"""`minds`: what a person should mind before building, the gravest first, in few lines."""

import re

_SENTENCE, _MOST = 640, 7
"""Longest sentence in letters, and most sentences."""

_PLACE = re.compile(r"\[[^\]]*\]")
_CLOTH = re.compile(r"\b(cloth|seam|felt|fabric|snip|notch|skin)", re.IGNORECASE)
_MOTOR = re.compile(r"\b(motor|torque|N mm)\b")


def minds(problems: tuple[str, ...], warnings: tuple[str, ...]) -> list[str]:
    """Problems first, then what motors bear, then what else must fit, then cloth; how many more there are."""
    ordered = [*merged(problems), *sorted(merged(warnings), key=_rank)]
    shown = [shortened(sentence(words), _SENTENCE) for words in ordered[:_MOST]]
    if len(ordered) > _MOST:
        shown.append(f"… and {len(ordered) - _MOST} more in manifest.json")
    return shown


def _rank(words: str) -> int:
    return 0 if _MOTOR.search(words) else 2 if _CLOTH.search(words) else 1


def merged(sentences: tuple[str, ...]) -> list[str]:
    """Sentences that differ only in one place in brackets are told as one, with all places."""
    kinds: dict[str, list[str]] = {}
    for words in dict.fromkeys(sentences):
        key = _PLACE.sub("[]", words) if len(_PLACE.findall(words)) == 1 else words
        kinds.setdefault(key, []).append(words)
    told = []
    for alike in kinds.values():
        places = [place[0] for words in alike if (place := _PLACE.search(words))]
        told.append(_PLACE.sub(", ".join(places), alike[0]) if len(alike) > 1 else alike[0])
    return told


def sentence(words: str) -> str:
    """Words with a capital letter in front and a full stop behind."""
    line = " ".join(words.split())
    return line and line[0].upper() + line[1:] + ("" if line.endswith((".", "!", "?")) else ".")


def shortened(text: str, most: int) -> str:
    """On one line, and of at most so many letters: the end of longer ones is an ellipsis."""
    line = " ".join(text.split())
    return line if len(line) <= most else line[: most - 1].rstrip() + "…"
