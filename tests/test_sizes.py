"""Limits of sizes, names and docstrings. Oracle: the syntax tree of each file."""

import ast
import inspect
import re
from collections import Counter
from collections.abc import Iterator
from functools import cache
from itertools import pairwise
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
FILE, TEST_FILE, FUNCTION, PARAMETERS = 400, 500, 60, 8


LARGE_FUNCTIONS = {
    "hydrostat/cli/drive.py:drive": "its signature is long",
    "hydrostat/cli/fabricate.py:fabricate": "its signature is long",
    "hydrostat/cli/firmware.py:firmware": "its signature is long",
    "hydrostat/cli/identify.py:identify": "its signature is long",
    "hydrostat/cli/play.py:play": "its signature is long",
    "hydrostat/cli/sample.py:sample": "its signature is long",
    "hydrostat/cli/simulate.py:simulate": "its signature is long",
    "hydrostat/cli/train.py:train": "its signature is long",
    "hydrostat/cli/trajectory.py:trajectory": "its signature is long",
    "hydrostat/ik/trajectory/solve_ik_trajectory.py:solve_ik_trajectory": "its signature is long",
}
MANY_PARAMETERS = {
    "hydrostat/cli/fabricate.py:fabricate": "a parameter is an option of the command line",
    "hydrostat/cli/firmware.py:firmware": "a parameter is an option of the command line",
    "hydrostat/cli/identify.py:identify": "a parameter is an option of the command line",
    "hydrostat/cli/new.py:new": "a parameter is an option of the command line",
    "hydrostat/cli/pose.py:pose": "a parameter is an option of the command line",
    "hydrostat/cli/grasp.py:grasp": "a parameter is an option of the command line",
    "hydrostat/cli/measure.py:measure": "a parameter is an option of the command line",
    "hydrostat/cli/compare.py:compare": "a parameter is an option of the command line",
    "hydrostat/cli/play.py:play": "a parameter is an option of the command line",
    "lab/hydrostat_lab/reproduce.py:reproduce": "a parameter is an option of the command line",
    "hydrostat/cli/sample.py:sample": "a parameter is an option of the command line",
    "hydrostat/cli/train.py:train": "a parameter is an option of the command line",
    "hydrostat/cli/simulate.py:simulate": "a parameter is an option of the command line",
    "hydrostat/cli/trajectory.py:trajectory": "a parameter is an option of the command line",
    "hydrostat/robot/sketch.py:sketch_robot": "a parameter is a number that a person may leave out",
    "hydrostat/ik/trajectory/solve_ik_trajectory.py:solve_ik_trajectory": "what `solve_ik` takes, and what is of time",
}
"""What may be larger, with the reason."""

HEADLESS = re.compile(r"(What|How|Whether|Where|Which|Of|That|As)\b")
PARTICIPLE = re.compile(
    r"(?!(feed|need|seed|speed)$)[a-z]+ed|found|held|made|told|seen|felt|given|taken|begun|kept|chosen"
)
FRAGMENT = re.compile(r"(what|how|whether|where|which|whose|of|that|as)\b")

BRITISH = re.compile(
    r'colour|(?<!")centre|neighbour|metre|behaviour|(?<!native\.)factoris[ei]|'
    r"(?:minimi|optimi|lineari|normali|initiali|tetrahedrali)s(?:e|ing|ation)",
    re.IGNORECASE,
)
"""Spellings that CONTRIBUTING.md does not want; the compiled core and map.json keep theirs."""

Function = ast.FunctionDef | ast.AsyncFunctionDef


def modules(folder: str = "hydrostat") -> dict[str, str]:
    """Text of each file of the package, by its path."""
    return {
        str(file.relative_to(ROOT)): file.read_text(encoding="utf-8") for file in sorted((ROOT / folder).rglob("*.py"))
    }


@cache
def syntax(text: str) -> ast.Module:
    """Syntax tree of a file."""
    return ast.parse(text)


@cache
def lines_of(text: str) -> list[str]:
    """Lines of a file."""
    return text.splitlines()


def functions(node: ast.AST, name: str = "") -> Iterator[tuple[str, Function]]:
    """Every function with its full name, also within classes and functions."""
    for child in ast.iter_child_nodes(node):
        if isinstance(child, ast.expr):  # in which no function is defined
            continue
        inner = f"{name}.{child.name}" if isinstance(child, Function | ast.ClassDef) else name
        if isinstance(child, Function):
            yield inner.removeprefix("."), child
        yield from functions(child, inner)


def code_lines(text: str, function: Function) -> int:
    """Lines of a function without its decorators, docstring, blank lines and comments."""
    docstring = function.body[0] if ast.get_docstring(function) is not None else None
    told = range(docstring.lineno, (docstring.end_lineno or 0) + 1) if docstring else ()
    lines = enumerate(lines_of(text)[function.lineno - 1 : function.end_lineno], function.lineno)
    return sum(number not in told and bool(line.strip()) and line.strip()[0] != "#" for number, line in lines)


def parameters(function: Function) -> int:
    """Parameters of a function; self and cls do not count."""
    named = [*function.args.posonlyargs, *function.args.args, *function.args.kwonlyargs]
    return sum(each.arg not in {"self", "cls"} for each in named)


def large_files(texts: dict[str, str]) -> dict[str, int]:
    return {path: count for path, text in texts.items() if (count := len(text.splitlines())) > FILE}


def large_functions(texts: dict[str, str]) -> dict[str, int]:
    return {
        f"{path}:{name}": count
        for path, text in texts.items()
        for name, function in functions(syntax(text))
        if (count := code_lines(text, function)) > FUNCTION
    }


def many_parameters(texts: dict[str, str]) -> dict[str, int]:
    return {
        f"{path}:{name}": count
        for path, text in texts.items()
        for name, function in functions(syntax(text))
        if (count := parameters(function)) > PARAMETERS
    }


def british(texts: dict[str, str]) -> list[str]:
    """Words of files in British spelling."""
    return [f"{path}: {word}" for path, text in texts.items() for word in BRITISH.findall(text)]


def twice(texts: dict[str, str]) -> list[str]:
    """Names of classes that stand at the top of several files."""
    names = Counter(
        node.name for text in texts.values() for node in syntax(text).body if isinstance(node, ast.ClassDef)
    )
    return sorted(name for name, count in names.items() if count > 1)


def fragments(texts: dict[str, str]) -> list[str]:
    """First lines of public docstrings that begin with a word that needs another sentence before it."""
    found = []
    for path, text in texts.items():
        tree = syntax(text)
        nodes = [tree, *(node for node in ast.walk(tree) if isinstance(node, Function | ast.ClassDef))]
        for node in nodes:
            public = isinstance(node, ast.Module) or not node.name.startswith("_")
            first = (ast.get_docstring(node) or "").split("\n")[0]
            if public and re.match(r"(Of|That|As)\b", first):
                found.append(f"{path}: {first}")
    return found


def docstrings(tree: ast.Module) -> Iterator[str]:
    """Docstrings of a module, its classes and functions, also private ones, and the texts below its fields."""
    for node in ast.walk(tree):
        if isinstance(node, Function | ast.ClassDef | ast.Module):
            yield ast.get_docstring(node) or ""
        body = getattr(node, "body", None)
        for before, after in pairwise(body) if isinstance(body, list) else ():
            if isinstance(before, ast.Assign | ast.AnnAssign) and isinstance(after, ast.Expr):
                text = after.value.value if isinstance(after.value, ast.Constant) else ""
                yield inspect.cleandoc(text) if isinstance(text, str) else ""


def half_entries(docstring: str) -> list[str]:
    """Entries of the lists of attributes and arguments that begin with a question word or a fragment."""
    found, section = [], ""
    for line in docstring.splitlines():
        if heading := re.fullmatch(r"(\w+):", line):
            section = heading[1]
        entry = re.fullmatch(r"    (\w+): (.+)", line)
        if section in {"Attributes", "Args"} and entry and FRAGMENT.match(entry[2]):
            found.append(line.strip())
    return found


def unknown_entries(texts: dict[str, str]) -> list[str]:
    """Entries of the lists of attributes and arguments that are no name in the class or function."""
    found = []
    for path, text in texts.items():
        for node in ast.walk(syntax(text)):
            if isinstance(node, Function | ast.ClassDef) and (docstring := ast.get_docstring(node)):
                sections = re.split(r"^(\w+):$", docstring, flags=re.MULTILINE)
                listed = [
                    name
                    for heading, entries in zip(sections[1::2], sections[2::2], strict=True)
                    for name in re.findall(r"^    (\w+): ", entries, re.MULTILINE)
                    if heading in {"Args", "Attributes"}
                ]
                names = {word for each in ast.walk(node) for word in _names(each)} if listed else set()
                found += [f"{path}: {node.name}: {name}" for name in listed if name not in names]
    return found


def _names(node: ast.AST) -> list[str]:
    """Names that a node introduces: parameters, variables, attributes, methods."""
    values = (getattr(node, key, None) for key in ("arg", "id", "attr", "name"))
    return [value for value in values if isinstance(value, str)]


def headless(texts: dict[str, str]) -> list[str]:
    """First lines and entries of docstrings that begin with a question word or a fragment."""
    found = []
    for path, text in texts.items():
        for docstring in docstrings(syntax(text)):
            first = docstring.split("\n")[0]
            found += [f"{path}: {line}" for line in [first] * bool(HEADLESS.match(first)) + half_entries(docstring)]
    return found


def participles(texts: dict[str, str]) -> list[str]:
    """Functions and methods named by one bare participle, also private ones; properties may be states."""
    found = []
    for path, text in texts.items():
        classes = [node for node in syntax(text).body if isinstance(node, ast.ClassDef)]
        for function in [node for owner in [syntax(text), *classes] for node in owner.body]:
            if isinstance(function, Function) and PARTICIPLE.fullmatch(function.name.strip("_")):
                state = any("property" in ast.unparse(decorator) for decorator in function.decorator_list)
                found += [f"{path}: {function.name}"] * (not state)
    return found


def asks_for_energies(texts: dict[str, str], energies: set[str]) -> list[str]:
    """Places outside mechanics that ask what kind of energy one is."""
    found = []
    for path, text in texts.items():
        if path.startswith("hydrostat/mechanics/"):
            continue
        for node in ast.walk(syntax(text)):
            if isinstance(node, ast.Call) and ast.unparse(node.func) == "isinstance":
                kinds = set(re.findall(r"\w+", ast.unparse(node.args[1])))
                found += [f"{path}:{node.lineno}"] * bool(kinds & energies)
    return found


def energies(texts: dict[str, str]) -> set[str]:
    """Names of Energy and of all classes that are one."""
    bases = {
        node.name: {ast.unparse(base).split("[")[0] for base in node.bases}
        for text in texts.values()
        for node in ast.walk(syntax(text))
        if isinstance(node, ast.ClassDef)
    }
    known = {"Energy"}
    while more := {name for name, above in bases.items() if above & known} - known:
        known |= more
    return known


@pytest.fixture(scope="module")
def texts() -> dict[str, str]:
    return modules() | modules("lab/hydrostat_lab")


def test_files_are_short(texts: dict[str, str]) -> None:
    assert not large_files(texts)


def test_files_of_tests_are_short() -> None:
    texts = modules("tests") | modules("lab/tests")
    assert [path for path, text in texts.items() if len(lines_of(text)) > TEST_FILE] == []


def test_functions_are_short(texts: dict[str, str]) -> None:
    assert set(large_functions(texts)) <= set(LARGE_FUNCTIONS)


def test_parameters_are_few(texts: dict[str, str]) -> None:
    assert set(many_parameters(texts)) <= set(MANY_PARAMETERS)


def test_a_class_name_stands_once(texts: dict[str, str]) -> None:
    assert twice(texts) == []


def test_first_lines_stand_alone(texts: dict[str, str]) -> None:
    assert fragments(texts) == []


def test_docstrings_begin_with_a_verb_or_a_noun(texts: dict[str, str]) -> None:
    assert headless(texts) == []


def test_spelling_is_american(texts: dict[str, str]) -> None:
    pages = {str(page.relative_to(ROOT)): page.read_text(encoding="utf-8") for page in (ROOT / "docs").rglob("*.md")}
    assert british(texts | pages) == []


def test_docstrings_list_names_that_exist(texts: dict[str, str]) -> None:
    assert unknown_entries(texts) == []


def test_functions_have_a_verb(texts: dict[str, str]) -> None:
    assert participles(texts) == []


def test_only_mechanics_asks_what_an_energy_is(texts: dict[str, str]) -> None:
    known = energies(texts)
    assert len(known) > 8
    assert asks_for_energies(texts, known) == []


def test_the_checks_can_fail() -> None:
    long = 'def long(a):\n    """Told."""\n\n    # why\n' + "    a += 1\n" * FUNCTION
    assert large_functions({"p": long}) == {"p:long": FUNCTION + 1}
    assert large_functions({"p": long.removesuffix("    a += 1\n")}) == {}
    assert large_files({"p": "\n" * FILE, "q": "\n" * (FILE + 1)}) == {"q": FILE + 1}
    few = "class A:\n    def f(self, a, b, /, c, d, *, e, f, g, h):\n        pass\n"
    assert many_parameters({"p": few, "q": few.replace("h)", "h, i)")}) == {"q:A.f": PARAMETERS + 1}
    assert twice({"p": "class A: pass\nclass B: pass", "q": "class A: pass"}) == ["A"]
    told = '"""As told."""\ndef f(): "That is it."\ndef _g(): "Of g."\ndef h(): "Assembly of h."\n'
    assert fragments({"p": told}) == ["p: As told.", "p: That is it."]
    asking = 'class A:\n    """Ok.\n\n    Attributes:\n        x: of y.\n        z: a thing of y.\n    """\n'
    asking += '\n    def _f(): "How."\n\n\nX = 1\n"""Where."""\nY = 1\n"""Whereabouts."""\n'
    assert sorted(headless({"h/a/b.py": asking})) == ["h/a/b.py: How.", "h/a/b.py: Where.", "h/a/b.py: x: of y."]
    assert headless({"h/b.py": '"""What."""'}) == ["h/b.py: What."]
    assert british({"p": 'Centre("centre", native.factorise, Minimise)'}) == ["p: Centre", "p: Minimise"]
    listed = 'def f(a):\n    """Do.\n\n    Args:\n        a: one.\n        b: two.\n    """\n'
    assert unknown_entries({"p": listed}) == ["p: f: b"]
    named = "def moved():\n    def turned(): ...\ndef move(): ...\nclass _B:\n    def _held(self): ...\n"
    named += "class A:\n    @property\n    def closed(self): ...\n    def found(self): ...\n    def seed(self): ...\n"
    assert participles({"h/b.py": named}) == ["h/b.py: moved", "h/b.py: _held", "h/b.py: found"]
    made = "class Energy: ...\nclass Spring(Energy): ...\nclass Stiff(Spring): ...\nclass Other: ..."
    assert energies({"p": made}) == {"Energy", "Spring", "Stiff"}
    asking = "isinstance(a, Other)\nisinstance(a, Stiff | Other)\n"
    places = asks_for_energies({"hydrostat/a/b.py": asking, "hydrostat/mechanics/c.py": asking}, energies({"p": made}))
    assert places == ["hydrostat/a/b.py:2"]


def test_files_of_tests_have_names_of_their_own() -> None:
    """Two of one name cannot be collected together."""
    names = Counter(file.name for top in ("tests", "lab") for file in (ROOT / top).rglob("test_*.py"))
    assert [name for name, count in names.items() if count > 1] == []
