"""What is wrong with the tables and keys of a file such as robot.toml, in hydrostat's words instead of pydantic's."""

from difflib import get_close_matches
from typing import Any

from pydantic import ValidationError

from hydrostat.robot.schema import RobotTable, Table
from hydrostat.units import quote

_NAMED = "a material with a name has its own; remove this key, or the name"
_VISCOUS = 'material = { name = "polyester fibre", viscosity = "40 Pa s" }'
REFUSED = {
    "body.gravity": "gravity stands at the top of the file, before [body]; move it there",
    "body.viscosity": "it belongs to the material; write " + _VISCOUS,
    "body.relaxation": "it belongs to the material; write " + _VISCOUS,
    "body.material.young": _NAMED,
    "body.material.poisson": _NAMED,
    "body.material.density": _NAMED,
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
    "density": 'density = "40 kg/m^3"',
    "relaxation": 'relaxation = [{ modulus = "10 kPa", time = "2 s" }]',
    "modulus": 'modulus = "10 kPa"',
    "time": 'time = "2 s"',
    "at": "at = [0, 0]",
    "box": "box = [[0, 0], [10, 20]]",
    "winch": 'winch = "left"',
    "points": "points = [[0, 0], [10, 20]]",
    "sheathed": "sheathed = [[0, 1]]",
    "targets": "targets = { tip = [40, 90] }",
    "outline": "outline = [[0, 0], [10, 0], [10, 20]]",
    "cables_per_winch": "cables_per_winch = 4",
    "locked_cables": "locked_cables = [1, 2]",
    "locked_winches": 'locked_winches = ["left"]',
}


def first_complaint(error: ValidationError, form: type[Table] = RobotTable) -> tuple[str, str]:
    """Key such as cable[1].points[0], and what is wrong with it; unknown keys first, for they explain missing ones."""
    errors = error.errors()
    worst: Any = next((entry for entry in errors if entry["type"] == "extra_forbidden"), errors[0])
    location = tuple(step for step in worst["loc"] if not str(step).startswith("<"))
    return _dotted(location), _message(worst, location, form)


def allowed_keys(key: str, form: type[Table] = RobotTable) -> list[str]:
    """Keys that the table at a key such as cable[1], in any of its forms, may have; none if it is no table."""
    tables = [form]
    for step in filter(None, key.split(".")):
        name = step.partition("[")[0]
        fields = [table.model_fields[name] for table in tables if name in table.model_fields]
        tables = [inner for field in fields for inner in _tables(field.annotation)]
    return list(dict.fromkeys(name for table in tables for name in table.model_fields))


def _message(error: Any, location: tuple[Any, ...], form: type[Table]) -> str:
    names = [step for step in location if isinstance(step, str)]
    key = names[-1] if names else ""
    value, limits = quote(error["input"]), error.get("ctx", {})
    match error["type"]:
        case "extra_forbidden":
            return REFUSED.get(".".join(names)) or _unknown(key, _dotted(location[:-1]), form)
        case "missing":
            return f"the key {quote(key)} is missing; write {_EXAMPLES[key]}"
        case "enum":
            return f"{value} is not known; allowed are: {str(limits['expected']).replace(chr(39), '')}"
        case "string_type":
            return f'{value} is not text; write it in quotes: "..."'
        case "string_too_short":
            return "must not be empty"
        case "string_too_long":
            return f"{value} is too long; at most {limits['max_length']} characters are allowed"
        case "bool_type":
            return f"{value} is neither true nor false"
        case "int_type":
            return f"{value} is not a whole number; write for example {_EXAMPLES[key]}"
        case "list_type" if len(location) == 1 and allowed_keys(key, form):
            return f"begin each with [[{key}]], in two pairs of brackets"
        case "list_type":
            return f"{value} is not a list; write for example {_EXAMPLES.get(key, '[0, 0]')}"
        case "too_short":
            return f"has {limits['actual_length']} entries, at least {limits['min_length']} are needed"
        case "too_long":
            return f"has more than {limits['max_length']} entries"
        case "model_type" | "dict_type" if len(location) == 1:
            return f"must be one table, begun with [{key}] in one pair of brackets"
        case "model_type" | "dict_type":
            return f"{value} is not a table" + (f"; write for example {_EXAMPLES[key]}" if key == "targets" else "")
    return error["msg"].removeprefix("Value error, ")


def _unknown(key: str, table: str, form: type[Table]) -> str:
    allowed = allowed_keys(table, form)
    similar = get_close_matches(key[:60], allowed, n=1)
    hint = f", did you mean {similar[0]}?" if similar else ";"
    return f"unknown key {quote(key)}{hint} allowed here are: {', '.join(allowed)}"


def _dotted(location: tuple[Any, ...]) -> str:
    text = "".join(f"[{step}]" if isinstance(step, int) else f".{step}" for step in location)
    return text.removeprefix(".")


def _tables(annotation: Any) -> list[type[Table]]:
    if isinstance(annotation, type) and issubclass(annotation, Table):
        return [annotation]
    return [table for part in getattr(annotation, "__args__", ()) for table in _tables(part)]
