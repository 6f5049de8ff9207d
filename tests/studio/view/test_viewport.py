"""The view as an element of a page: what it is given and what it is told. Oracle: NiceGUI's own record of elements."""

from nicegui import ui
from nicegui.client import Client
from nicegui.dependencies import esm_modules

from hydrostat.drawing import Color
from hydrostat.studio.face.viewport import MODULES, STATIC, Viewport


def test_modules_are_served_with_three() -> None:
    served = {module.name: module.path for module in esm_modules.values()}
    assert served["hydrostat-view"] == MODULES
    assert (served["nicegui-scene"] / "index.js").is_file()
    assert (MODULES / "index.js").is_file()
    assert Viewport.component is not None
    assert Viewport.component.path == STATIC / "viewport.js"


def test_every_module_that_is_imported_is_there() -> None:
    for file in MODULES.glob("*.js"):
        for line in file.read_text(encoding="utf-8").splitlines():
            if line.startswith("import ") and '"./' in line:
                assert (MODULES / line.split('"./')[1].split('"')[0]).is_file(), f"{file.name}: {line}"


def test_props() -> None:
    with Client(ui.page("/view-of-a-test")):
        view = Viewport(stream="/stream", brush=True)
        assert view.props["stream"] == "/stream"
        assert view.props["palette"]["felt"] == Color.FELT
        assert tuple(view.props["palette"]["tension"]) == Color.TENSION
        assert view.props["brush"] is True
        assert view.props["dark"] is None
        view.set_dark(True)
        view.set_brush(False)
        assert view.props["dark"] is True
        assert view.props["brush"] is False


def test_methods_of_python_are_methods_of_the_component() -> None:
    text = (STATIC / "viewport.js").read_text(encoding="utf-8")
    methods = text[text.index("methods: {") :]
    for name in ("view", "fit", "section", "orthographic", "opacity", "mesh", "picture"):
        assert callable(getattr(Viewport, name))
        assert f"\n    {name}(" in methods
