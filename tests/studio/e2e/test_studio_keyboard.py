"""The studio by keys alone, and for a screen reader. The oracle is the browser's focus and accessibility tree."""

import re
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import pytest

pytestmark = pytest.mark.slow

if TYPE_CHECKING:
    from playwright.sync_api import Locator, Page

Open = Callable[..., "Page"]

MOST_STOPS = 120
"""No stage has more controls between two of them."""

CONTROLS = {
    "application", "button", "checkbox", "combobox", "dialog", "image", "link", "listbox", "menuitem", "option",
    "progressbar", "radio", "searchbox", "slider", "spinbutton", "switch", "tab", "textbox",
}  # fmt: skip

RING = """() => {
  const at = document.activeElement;
  const field = at.closest('.q-field--focused .q-field__control');
  const { outlineStyle, boxShadow } = getComputedStyle(at);
  return outlineStyle !== 'none' || boxShadow !== 'none' || !!field;
}"""
"""Whether the focus can be seen: a ring, or the frame of a box."""


def reach(page: "Page", control: "Locator") -> None:
    """Press Tab until a control has the focus, and see it there."""
    control.wait_for()
    for _ in range(MOST_STOPS):
        if control.evaluate("element => element === document.activeElement"):
            page.wait_for_function(RING)
            return
        page.keyboard.press("Tab")
    raise AssertionError(f"{control} is not reached by Tab")


def press(page: "Page", control: "Locator", key: str = "Enter") -> None:
    reach(page, control)
    page.keyboard.press(key)


def stage(page: "Page", name: str) -> "Locator":
    return page.get_by_test_id(f"stage-{name}")


def test_all_stages_by_keys_alone(rooms: str, window: Open) -> None:
    page = window(rooms)
    press(page, stage(page, "start"))
    press(page, page.get_by_test_id("gallery-starfish"))
    page.wait_for_function("window.__app && window.__app.connected && window.__app.painted > 0")

    marker = page.get_by_role("button", name=re.compile("^right( |$)"))
    press(page, marker, "Space")
    page.get_by_role("button", name=re.compile("^right( |$)"), pressed=True).wait_for()
    for key in ("Shift+ArrowUp", "Shift+ArrowUp", "ArrowLeft"):
        page.keyboard.press(key)
    page.get_by_label("Release right", exact=True).wait_for()
    page.wait_for_function("__app.items.some(item => item.key === 'target:right')")
    reach(page, marker)  # which the list has kept
    page.get_by_role("application", name="Robot view").get_by_text(re.compile(r"Targets: right .* mm off")).wait_for(
        state="attached"
    )
    reach(page, page.get_by_label("Name of the pose"))
    page.keyboard.type("hello")
    page.keyboard.press("Enter")
    page.get_by_label("Rename hello").wait_for()

    press(page, stage(page, "edit"))
    view = page.get_by_role("application", name="Robot view")
    reach(page, view)
    page.keyboard.press("m")
    page.get_by_role("button", name="Place markers", pressed=True).wait_for()
    page.keyboard.press("Enter")
    view.get_by_text(re.compile(r"Cross-hair: x .*, y .* mm")).wait_for(state="attached")
    page.keyboard.press("Shift+ArrowUp")
    page.keyboard.press("Enter")
    page.wait_for_function("__app.items.some(item => item.key === 'marker:marker_1')")
    view.get_by_text(re.compile(r"6 markers.*Selected: marker marker_1\. Cross-hair")).wait_for(state="attached")

    press(page, stage(page, "design"))
    for other in ("wave", "star_jump"):
        press(page, page.get_by_role("checkbox", name=other, checked=True), "Space")
        page.get_by_role("checkbox", name=other, checked=False).wait_for()
    for left in (5, 4, 3, 2):
        press(page, page.get_by_test_id("fewer-cables"))
        page.get_by_test_id("design-cables").get_by_text(str(left), exact=True).wait_for()
    press(page, page.get_by_test_id("design-go"))
    page.get_by_test_id("design-card").first.wait_for()
    press(page, page.get_by_test_id("design-card").first, "Space")
    press(page, page.get_by_test_id("design-accept"))

    press(page, stage(page, "drive"))
    press(page, page.get_by_role("slider", name="winch_1"), "PageUp")
    press(page, page.get_by_role("button", name="Add", exact=True))
    line = page.get_by_role("slider", name="Timeline")
    press(page, line, "End")
    press(page, page.get_by_role("button", name="Add", exact=True))
    press(page, line, "PageUp")
    page.wait_for_function("document.querySelector('[aria-label=Timeline]').ariaValueText.endsWith('keyframe 1 of 2')")

    press(page, stage(page, "export"))
    with page.expect_download() as caught:
        press(page, page.get_by_test_id("export-robot"))
    assert caught.value.suggested_filename == "starfish.zip"
    assert page.evaluate("__app.errors") == []


def nodes(page: "Page") -> list[dict[str, Any]]:
    """Tree of a screen reader: role, name and level of each element that is not hidden from it."""
    session = page.context.new_cdp_session(page)
    tree = session.send("Accessibility.getFullAXTree")["nodes"]
    session.detach()
    return [
        {
            "role": node["role"]["value"],
            "name": node.get("name", {}).get("value", ""),
            "level": next((own["value"]["value"] for own in node.get("properties", []) if own["name"] == "level"), 0),
        }
        for node in tree
        if not node.get("ignored")
    ]


def unnamed(page: "Page") -> list[dict[str, Any]]:
    """Controls without a name of their own: none, that of a sign, or the browser's words for a file."""
    bare = re.compile(r"^$|^Choose Files?|^(add_box|cloud_upload|arrow_drop_down)$")
    return [node for node in nodes(page) if node["role"] in CONTROLS and bare.search(node["name"])]


def test_every_control_has_a_name_and_headings_nest(rooms: str, window: Open) -> None:
    page = window(rooms)
    for name in ("edit", "pose", "design", "drive", "export", "start"):
        stage(page, name).click()
        page.wait_for_function(
            "name => document.querySelector(`[data-testid=stage-${name}][aria-pressed=true]`)", arg=name
        )
        page.locator("[role=heading][aria-level='1']:visible").first.wait_for()
        for fold in reversed(page.locator(".q-expansion-item--collapsed > div > .q-item:visible").all()):
            fold.click()
        assert unnamed(page) == [], name
        levels = [node["level"] for node in nodes(page) if node["role"] == "heading"]
        assert levels.count(1) == 1, name
        if name != "start":
            view = next(node for node in nodes(page) if node["role"] == "application")
            assert view["name"] == "Robot view"
            page.locator(".studio-viewport p", has_text=re.compile("^starfish: 5 markers")).wait_for(state="attached")
