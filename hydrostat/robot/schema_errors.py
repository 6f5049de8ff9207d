"""`first_complaint`: readable errors of tables that do not fit their schema."""

from difflib import get_close_matches
from typing import Any

from pydantic import ValidationError

from hydrostat.toml_schema import TomlTable
from hydrostat.units import quote

_NAMED = "a material with a name has its own; remove this key, or the name"
_VISCOUS = 'material = { name = "polyester fibre", viscosity = "40 Pa s" }'
REFUSED = {
    "body.gravity": "gravity stands at the top of the file, before [body]; move it there",
    "body.face": "where the cables of a flat robot run stands at the top of the file, before [body]; move it there",
    "body.viscosity": "it belongs to the material; write " + _VISCOUS,
    "body.relaxation": "it belongs to the material; write " + _VISCOUS,
    "body.hysteresis": "it belongs to the material; write " + _VISCOUS,
    **dict.fromkeys(("body.material.young", "body.material.poisson", "body.material.density"), _NAMED),
    **dict.fromkeys(
        ("keep_out", "passive_zone", "winch_zone"), "it belongs in a file for hydrostat design --constraints"
    ),
    "part": "parts belong to the body; begin each with [[body.part]]",
}
"""Known keys where they may not stand, and why."""

_EXAMPLES = {
    "format": "format = 1",
    "body": "[body]",
    "name": 'name = "left"',
    "gravity": 'gravity = ["0 m/s^2", "-9.81 m/s^2"]',
    "material": 'material = "polyester fibre"',
    "young": 'young = "30 kPa"',
    "poisson": "poisson = 0.3",
    "thickness": 'thickness = "40 mm"',
    "density": 'density = "40 kg/m^3"',
    "relaxation": 'relaxation = [{ modulus = "10 kPa", time = "2 s" }]',
    "hysteresis": 'hysteresis = [{ young = "10 kPa", strain = 0.05 }]',
    "modulus": 'modulus = "10 kPa"',
    "time": 'time = "2 s"',
    "force": 'force = ["0 N", "-1 N"]',
    "at": "at = [0, 0]",
    "box": "box = [[0, 0], [10, 20]]",
    "winch": 'winch = "left"',
    "points": "points = [[0, 0], [10, 20]]",
    "sheathed": "sheathed = [[0, 1]]",
    "targets": "targets = { tip = [40, 90] }",
    "outline": "outline = [[0, 0], [10, 0], [10, 20]]",
    "locked_cables": "locked_cables = [1, 2]",
    "locked_winches": 'locked_winches = ["left"]',
    "sheet.name": 'name = "felt"',
    "sheet.thickness": 'thickness = "0.8 mm"',
    "load.name": 'name = "push"',
    "drive.name": 'name = "base"',
    "marker.name": 'name = "tip"',
    "pose.name": 'name = "wave"',
    "rod.name": 'name = "spine"',
    "obstacle.name": 'name = "ball"',
    "sensor.name": 'name = "bend"',
    "body.part.name": 'name = "bone"',
}
"""Examples by key, with its table where the key alone says too little."""


_SENTENCES = {
    "missing": "the key {key} is missing; write {example}",
    "enum": "{value} is not known; allowed are: {expected}",
    "string_type": '{value} is not text; write it in quotes: "..."',
    "string_too_short": "must not be empty",
    "string_too_long": "{value} is too long; at most {max_length} characters are allowed",
    "bool_type": "{value} is neither true nor false; write one of them without quotes",
    "int_type": "{value} is not a whole number; write for example {example}",
    "list_type": "{value} is not a list; write for example {example}",
    "too_short": "has {actual_length} entries, at least {min_length} are needed",
    "too_long": "has more than {max_length} entries",
}
"""Our sentence for each of pydantic's kinds of errors."""


_BRANCHES = ("<", "function-", "list[")
"""Beginnings of what pydantic calls the kinds of value that a key may have; they are no keys."""


def first_complaint(error: ValidationError, form: type[TomlTable]) -> tuple[str, str]:
    """Return the key, such as cable[1].points[0], and the error; unknown keys first, as they explain missing ones."""
    errors = error.errors()
    worst: Any = next((entry for entry in errors if entry["type"] == "extra_forbidden"), errors[0])
    location = tuple(step for step in worst["loc"] if not str(step).startswith(_BRANCHES))
    return _dotted_path(location), _message(worst, location, form)


def allowed_keys(key: str, form: type[TomlTable]) -> list[str]:
    """Keys that the table at a key such as cable[1], in any of its forms, may have; none if it is no table."""
    tables = [form]
    for step in filter(None, key.split(".")):
        name = step.partition("[")[0]
        fields = [table.model_fields[name] for table in tables if name in table.model_fields]
        tables = [inner for field in fields for inner in _tables(field.annotation)]
    return list(dict.fromkeys(name for table in tables for name in table.model_fields))


def _message(error: Any, location: tuple[Any, ...], form: type[TomlTable]) -> str:
    names = [step for step in location if isinstance(step, str)]
    key, kind = names[-1] if names else "", error["type"]
    if kind == "extra_forbidden":
        return REFUSED.get(".".join(names)) or _unknown(key, _dotted_path(location[:-1]), form)
    if kind == "list_type" and len(location) == 1 and allowed_keys(key, form):
        return f"begin each with [[{key}]], in two pairs of brackets"
    if kind in ("model_type", "dict_type"):
        if len(location) == 1:
            return f"must be one table, begun with [{key}] in one pair of brackets"
        hint = f"; write for example {_EXAMPLES[key]}" if key == "targets" else ""
        return f"{quote(error['input'])} is not a table{hint}"
    if kind == "too_short" and location[:1] == ("pose",) and names[1:2] == ["targets"]:
        count = len(error["input"])
        return f"has {count} {'entry' if count == 1 else 'entries'}; a target is [x, y], on bodies in space [x, y, z]"
    if kind not in _SENTENCES:
        return error["msg"].removeprefix("Value error, ")
    limits = {name: str(limit).replace("'", "") for name, limit in error.get("ctx", {}).items()}
    example = _EXAMPLES.get(".".join(names)) or _EXAMPLES.get(key) or (f"{key} = 4" if kind == "int_type" else "[0, 0]")
    return _SENTENCES[kind].format(key=quote(key), value=quote(error["input"]), example=example, **limits)


def _unknown(key: str, table: str, form: type[TomlTable]) -> str:
    allowed = allowed_keys(table, form)
    similar = get_close_matches(key[:60], allowed, n=1)
    hint = f", did you mean {similar[0]}?" if similar else ";"
    return f"unknown key {quote(key)}{hint} allowed here are: {', '.join(allowed)}"


def _dotted_path(location: tuple[Any, ...]) -> str:
    text = "".join(f"[{step}]" if isinstance(step, int) else f".{step}" for step in location)
    return text.removeprefix(".")


def _tables(annotation: Any) -> list[type[TomlTable]]:
    if isinstance(annotation, type) and issubclass(annotation, TomlTable):
        return [annotation]
    return [table for part in getattr(annotation, "__args__", ()) for table in _tables(part)]
