"""Lazy imports at the door of a package: a public name loads its module when it is first used.

The door lists its names once, as imports under `if TYPE_CHECKING:`, which type checkers and import-linter read. The
same lines are read here at run time.
"""

import ast
import sys
from collections.abc import Callable
from functools import cached_property
from importlib import import_module
from importlib.machinery import EXTENSION_SUFFIXES
from importlib.util import find_spec, module_from_spec, spec_from_file_location
from pathlib import Path
from threading import Lock
from types import ModuleType
from typing import Any


def open_package(name: str) -> None:
    """Make the imports of a package that stand under `if TYPE_CHECKING:` lazy; call it last in `__init__.py`.

    `from package import room as room` there lets `package.room` be used without an import.
    """
    sys.modules[name].__class__ = _LazyPackage


def use_later(module: str, name: str) -> Callable[..., Any]:
    """Return a function that imports another at its first call, and calls it."""

    def call(*args: Any, **options: Any) -> Any:
        return getattr(import_module(module), name)(*args, **options)

    return call


def load_compiled(name: str) -> Any:
    """Load a compiled module of another package without the packages around it; None where it is not there.

    Packages of SciPy import much that one function does not need: scipy.optimize takes 0.2 s, its solver of nonnegative
    least squares 5 ms. The module is registered under its own name, thus these packages find it loaded later.
    """
    top, *middle, own = name.split(".")
    with _LOADING:
        package = name.rpartition(".")[0]
        if name in sys.modules or package in sys.modules:
            return sys.modules.get(name)
        import_module(top)  # says where its libraries are
        found = find_spec(top)
        for folder in (found.submodule_search_locations or ()) if found is not None else ():
            for suffix in EXTENSION_SUFFIXES:
                file = Path(folder, *middle, own + suffix)
                if file.is_file():
                    return _load_file(name, file)
    return None


def _load_file(name: str, file: Path) -> Any:
    """Load a compiled module from its file; None where that fails."""
    spec = spec_from_file_location(name, file)
    if spec is None or spec.loader is None:
        return None
    try:
        module = module_from_spec(spec)
        spec.loader.exec_module(module)
    except ImportError:
        return None
    return sys.modules.setdefault(name, module)


_LOADING = Lock()


class _LazyPackage(ModuleType):
    """Package that loads its public names on first access."""

    __all__: list[str]

    def __getattr__(self, name: str) -> Any:
        if name in self._rooms:
            return import_module(f"{self.__name__}.{name}")
        if name not in self.__all__:
            from difflib import get_close_matches

            near = get_close_matches(name, self.__all__, n=1)
            hint = f". Did you mean {near[0]!r}?" if near else ""
            raise AttributeError(f"module {self.__name__!r} has no attribute {name!r}{hint}")
        module, original = self._homes[name]
        value = getattr(import_module(module), original)
        self.__dict__[name] = value
        return value

    def __setattr__(self, name: str, value: object) -> None:
        """Keep a public name from its own module, which importing binds to the package under the same name."""
        if not (isinstance(value, ModuleType) and name in self.__all__):
            super().__setattr__(name, value)

    def __dir__(self) -> list[str]:
        return sorted({*self.__dict__, *self.__all__, *self._rooms})

    @cached_property
    def _homes(self) -> dict[str, tuple[str, str]]:
        """Module of each name, and its name there."""
        others = (node for node in self._lazy_imports if node.module != self.__name__)
        return {alias.asname or alias.name: (str(node.module), alias.name) for node in others for alias in node.names}

    @cached_property
    def _rooms(self) -> set[str]:
        """Names of the subpackages that load on first access."""
        return {alias.name for node in self._lazy_imports if node.module == self.__name__ for alias in node.names}

    @cached_property
    def _lazy_imports(self) -> list[ast.ImportFrom]:
        """Imports under `if TYPE_CHECKING:`."""
        with open(str(self.__file__), encoding="utf-8") as file:
            tree = ast.parse(file.read())
        blocks = [node for block in tree.body if isinstance(block, ast.If) for node in block.body]
        return [node for node in blocks if isinstance(node, ast.ImportFrom)]
