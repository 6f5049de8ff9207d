"""`take_records`: options of a command that come to it as records."""

from collections.abc import Callable
from dataclasses import fields, is_dataclass
from functools import wraps
from inspect import Parameter, signature
from typing import Any, get_type_hints


def take_records(command: Callable[..., None]) -> Callable[..., None]:
    """Command with an option for each field of its records, in their order, with its annotation and its default."""
    hints = get_type_hints(command, include_extras=True)
    own = signature(command)
    options: list[Parameter] = []
    records = {name: hints[name] for name in own.parameters if is_dataclass(hints[name])}
    for name, parameter in own.parameters.items():
        if name not in records:
            options.append(parameter.replace(annotation=hints[name], kind=Parameter.KEYWORD_ONLY))
            continue
        kinds = get_type_hints(records[name], include_extras=True)
        options += [
            Parameter(each.name, Parameter.KEYWORD_ONLY, default=each.default, annotation=kinds[each.name])
            for each in fields(records[name])
        ]

    @wraps(command)
    def run(**given: Any) -> None:
        for name, record in records.items():
            given[name] = record(**{each.name: given.pop(each.name) for each in fields(record)})
        command(**given)

    run.__signature__ = own.replace(parameters=options)  # type: ignore[attr-defined]
    return run
