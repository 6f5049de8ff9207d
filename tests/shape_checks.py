"""Shapes and types of the package's public functions are checked while the tests run, in the first calls of each test.

An import hook decorates public functions and classes. Checking each call made the tests four times as slow, nearly all
of it in inner loops and private functions, whose arrays come from public ones. So only public ones are wrapped. The
check is made when a function is first called, and each test checks the first `CALLS` calls of each function again:
the errors that a test catches do not depend on the tests before it. jaxtyping has such a hook: it decorates private
functions too and imports JAX, which takes three times as long.
"""

import ast
import inspect
import sys
from collections.abc import Callable, Sequence
from functools import cache, partial, wraps
from importlib.abc import MetaPathFinder
from importlib.machinery import ModuleSpec, PathFinder, SourceFileLoader
from importlib.util import cache_from_source, decode_source
from types import CodeType, FunctionType, ModuleType
from typing import Any
from unittest.mock import patch
from warnings import catch_warnings, simplefilter

import jaxtyping._decorator
from beartype import BeartypeConf, beartype
from beartype.roar import (
    BeartypeCallHintReturnViolation,
    BeartypeCallHintViolation,
    BeartypeDecorHintPep673Exception,
)
from jaxtyping import TypeCheckError, config, jaxtyped
from jaxtyping._decorator import _destring_annotation
from jaxtyping._storage import pop_shape_memo, push_shape_memo, shape_str

CALLS = 10
"""Calls of each function that a test checks."""

jaxtyping._decorator._tb_flag = False  # otherwise jaxtyped imports JAX to shorten JAX's tracebacks

_beartype = beartype(conf=BeartypeConf(is_pep484_tower=True))
"""An int is a float, as PEP 484 says."""

_counting: list["_Counter"] = []
"""Counters of the functions that this test has called."""


def install(package: str) -> None:
    """Check a package that is imported from now on."""
    sys.meta_path.insert(0, _Finder(package))


def begin_test() -> None:
    """Check the first calls of each function again."""
    for counter in _counting:
        counter.begin()
    _counting.clear()


def checked(function: Callable[..., Any]) -> Callable[..., Any]:
    """Check the first calls of a function in each test. Later calls run its own code, as if it were not wrapped.

    The result is a copy of the function whose code object is exchanged, which costs the later calls nothing.
    """
    assert isinstance(function, FunctionType)
    public = _copy(function)
    wraps(function)(public)
    counter = _Counter(function, public)
    _exchange(public, counter.code)
    return public


def _copy(function: FunctionType) -> FunctionType:
    """Copy a function, without its names and annotations."""
    code = function.__code__
    made = FunctionType(code, function.__globals__, function.__name__, function.__defaults__, function.__closure__)
    made.__kwdefaults__ = function.__kwdefaults__
    return made


def _exchange(function: FunctionType, code: CodeType) -> None:
    """Give a function another code object; from Python 3.13 on that of a generator warns."""
    with catch_warnings():
        simplefilter("ignore", DeprecationWarning)
        function.__code__ = code


@cache
def _count_call(free: int) -> CodeType:
    """Code that calls a counter, whose place the constant "counter" takes, in a frame with `free` free variables.

    They are named after the end, or a frame has none of them, and ends Python where a traceback asks for its locals.
    """
    names = "".join(f"v{number}, " for number in range(free))
    lines = (f"def make({names}):", " def count(*args, **kwargs):", "  return 'counter'(*args, **kwargs)")
    space: dict[str, Any] = {}
    with catch_warnings():
        simplefilter("ignore", SyntaxWarning)  # a text is not called
        exec("\n".join([*lines, f"  ({names})", " return count"]), space)
    return space["make"](*[None] * free).__code__


class _Counter:
    """Calls of a function in a test, of which it checks the first."""

    def __init__(self, function: Callable[..., Any], public: FunctionType) -> None:
        self._function, self._public = function, public
        self._checking: Callable[..., Any] | None = None
        self.calls = 0
        code = _count_call(len(public.__code__.co_freevars))
        self.code = code.replace(co_consts=tuple(self if each == "counter" else each for each in code.co_consts))

    def __call__(self, *args: Any, **kwargs: Any) -> Any:
        if sys.is_finalizing():  # modules are gone that a check needs
            return self._function(*args, **kwargs)
        if not self.calls:
            _counting.append(self)
        self.calls += 1
        if self.calls >= CALLS:
            _exchange(self._public, self._function.__code__)
        if self.calls > CALLS or config.jaxtyping_disable:
            return self._function(*args, **kwargs)
        if self._checking is None:
            self._checking = _checking(self._function)
        return self._checking(*args, **kwargs)

    def begin(self) -> None:
        """Check the first calls again."""
        self.calls = 0
        _exchange(self._public, self.code)


def checked_public(made: Any) -> Any:
    """Check a public function, or the fields of a public record: the decorator that the import hook writes."""
    if not inspect.isclass(made):
        return checked(made)
    if "__dataclass_fields__" in vars(made) and "__init__" in vars(made) and not hasattr(made.__init__, "__wrapped__"):
        made.__init__ = checked(made.__init__)
    return made


def is_public(name: str) -> bool:
    """Tell whether the name of a function or class allows its use from outside its file."""
    return bool(name.strip("_")) and (name[0] != "_" or name.endswith("__"))


class _Finder(MetaPathFinder):
    """Finds the files of a package, to be loaded with checks."""

    def __init__(self, package: str) -> None:
        self._package = package

    def find_spec(
        self, name: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        if name.partition(".")[0] != self._package:
            return None
        spec = PathFinder.find_spec(name, path, target)
        if spec is not None and isinstance(spec.loader, SourceFileLoader):
            spec.loader = _Loader(spec.loader.name, spec.loader.path)
        return spec


class _Loader(SourceFileLoader):
    """Loads a file with checks; keeps its bytecode apart from the plain one."""

    def source_to_code(self, data: Any, path: Any, *, _optimize: int = -1) -> Any:
        tree = ast.parse(decode_source(data), path)
        decorate(tree.body)
        after = int(ast.get_docstring(tree, clean=False) is not None)
        after += sum(isinstance(node, ast.ImportFrom) and node.module == "__future__" for node in tree.body)
        added = ast.Import([ast.alias("shape_checks", lineno=1, col_offset=0)], lineno=1, col_offset=0)
        tree.body.insert(after, added)
        return compile(tree, path, "exec", dont_inherit=True, optimize=_optimize)

    def exec_module(self, module: ModuleType) -> None:
        place = partial(cache_from_source, optimization="shapes1")
        with patch("importlib._bootstrap_external.cache_from_source", place):  # under the lock of imports
            super().exec_module(module)


def decorate(body: list[ast.stmt]) -> None:
    """Decorate public functions and classes of a module, and methods of such classes."""
    for node in body:
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            if not is_public(node.name):
                continue
            is_class = isinstance(node, ast.ClassDef)
            mark = ast.Attribute(ast.Name("shape_checks", ast.Load()), "checked_public", ast.Load())
            ast.copy_location(mark, node)
            ast.copy_location(mark.value, node)
            node.decorator_list.insert(0 if is_class else len(node.decorator_list), mark)
            if is_class:
                decorate(node.body)
        else:
            for part in ("body", "orelse", "handlers", "finalbody"):
                decorate(getattr(node, part, []))


def _checking(function: FunctionType) -> Callable[..., Any]:
    """Check a function's arguments and result.

    jaxtyping's own decorator checks arguments again with the result, by functions that it writes and compiles; it
    checks generators, and what returns Self, which cannot be checked outside its class.
    """
    if inspect.isgeneratorfunction(function) or inspect.iscoroutinefunction(function):
        return jaxtyped(function, typechecker=_typechecker)
    hinted = _copy(function)
    hinted.__qualname__ = function.__qualname__
    hinted.__annotations__ = {
        name: _destring_annotation(hint, function.__globals__) for name, hint in function.__annotations__.items()
    }
    try:
        checking = _beartype(hinted)
    except BeartypeDecorHintPep673Exception:
        return jaxtyped(function, typechecker=_typechecker)

    def check(*args: Any, **kwargs: Any) -> Any:
        shapes = push_shape_memo({})
        try:
            return checking(*args, **kwargs)
        except BeartypeCallHintViolation as wrong:
            checked = "return value" if isinstance(wrong, BeartypeCallHintReturnViolation) else "parameters"
            raise TypeCheckError(f"{checked} of {function.__qualname__}: {wrong}\n{shape_str(shapes)}") from None
        finally:
            pop_shape_memo()

    return check


def _typechecker(function: Callable[..., Any]) -> Callable[..., Any]:
    """Check a function's arguments and result; one that returns Self cannot be checked outside its class."""
    try:
        return _beartype(function)
    except BeartypeDecorHintPep673Exception:
        return function
