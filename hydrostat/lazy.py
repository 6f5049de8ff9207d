"""Lazy imports at the door of a package: a public name loads its module when it is first used.

The door lists its names once, as imports under `if TYPE_CHECKING:`, which type checkers and import-linter read. The
same lines are read here at run time.
"""

import ast
import sys
from collections.abc import Callable
from functools import cached_property
from importlib import import_module
from types import ModuleType
from typing import Any


def open_package(name: str) -> None:
    """Make the imports of a package that stand under `if TYPE_CHECKING:` lazy; call it last in `__init__.py`."""
    sys.modules[name].__class__ = _LazyPackage


def use_later(module: str, name: str) -> Callable[..., Any]:
    """Return a function that imports another at its first call, and calls it."""

    def call(*args: Any, **options: Any) -> Any:
        return getattr(import_module(module), name)(*args, **options)

    return call


class _LazyPackage(ModuleType):
    """Package that loads its public names on first access."""

    __all__: list[str]

    def __getattr__(self, name: str) -> Any:
        if name not in self.__all__:
            raise AttributeError(f"module {self.__name__!r} has no attribute {name!r}", name=name, obj=self)
        module, original = self._homes[name]
        value = getattr(import_module(module), original)
        self.__dict__[name] = value
        return value

    def __setattr__(self, name: str, value: object) -> None:
        """Keep a public name from its own module, which importing binds to the package under the same name."""
        if not (isinstance(value, ModuleType) and name in self.__all__):
            super().__setattr__(name, value)

    def __dir__(self) -> list[str]:
        return sorted({*self.__dict__, *self.__all__})

    @cached_property
    def _homes(self) -> dict[str, tuple[str, str]]:
        """Module of each name, and its name there."""
        with open(str(self.__file__), encoding="utf-8") as file:
            tree = ast.parse(file.read())
        imports = (
            node
            for block in tree.body
            if isinstance(block, ast.If)
            for node in block.body
            if isinstance(node, ast.ImportFrom)
        )
        return {alias.asname or alias.name: (str(node.module), alias.name) for node in imports for alias in node.names}
