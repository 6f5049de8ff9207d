"""Keys that a page takes. Oracle: `preventDefault` of events, and which element has the focus."""

import shutil
from pathlib import Path

import pytest
from view_modules import needs_node, run

from hydrostat.studio.face.viewport import STATIC

PAGE = """
let now = 0;
const ears = {}, beats = [];
class Element {
  constructor(name) {
    Object.assign(this, { name, tagName: name, ariaLabel: name, dataset: {}, tabIndex: 0, isConnected: true });
  }
  closest(choice) { return choice.includes("button") && this.tagName === "button" ? this : null; }
  getClientRects() { return this.isConnected ? [1] : []; }
  matches() { return false; }
  querySelectorAll() { return this.inner ?? []; }
  blur() { document.activeElement = document.body; }
  focus() { document.activeElement = this; say("focusin", { target: this }); }
}
const say = (kind, event) => (ears[kind] ?? []).forEach((ear) => ear(event));
globalThis.addEventListener = (kind, ear) => (ears[kind] ??= []).push(ear);
globalThis.setInterval = (beat) => beats.push(beat);
globalThis.getSelection = () => "";
globalThis.Element = globalThis.HTMLElement = Element;
const nothing = () => null;
globalThis.document = { body: new Element("body"), getElementById: nothing, querySelector: nothing, hidden: true };
document.activeElement = document.body;
await import("./habits.js");
const panel = new Element("div");
panel.parentElement = document.body;
const draw = () => {
  const made = new Element("button");
  made.parentElement = panel;
  panel.inner = [made];
  return made;
};
const press = (more = {}) => {
  let taken = false;
  say("keydown", { key: "ArrowLeft", target: document.body, preventDefault: () => (taken = true), ...more });
  return taken;
};
"""

FOCUS = """
const steps = [];
const redraw = () => { panel.inner[0].isConnected = false; document.activeElement = document.body; draw(); };
let button = draw();
press({ key: "Tab" });
button.focus();
redraw();
beats.forEach((beat) => beat());
steps.push(document.activeElement.name); // who works by keys keeps the place
say("pointerdown", {});
panel.inner[0].focus();
panel.inner[0].blur();
redraw();
press({ key: "r" });
beats.forEach((beat) => beat());
steps.push(document.activeElement.name);
console.log(JSON.stringify(steps));
"""

ARROWS = "console.log(JSON.stringify([{}, { altKey: true }, { ctrlKey: true }, { metaKey: true }].map(press)));"

PARTS = """
const part = (await import("./" + given[0])).default;
const done = [];
const note = () => done.push(1);
const self = { $refs: { root: 1 }, view_: { camera: { zoom: note }, mark() {} }, tell: note, nudge: note, loops: [],
  open: null, removeCorner: note, undo: note, time: 0, seconds: 1, shown: 0, step: 1, chosen: null };
const results = [{}, { ctrlKey: true }, { metaKey: true }, { altKey: true }].map((held) => {
  let taken = false;
  const event = { key: given[1], target: 1, preventDefault: () => (taken = true), stopPropagation() {}, ...held };
  part.methods.key.call(self, event);
  return taken;
});
console.log(JSON.stringify([results, done.length]));
"""


@needs_node
@pytest.mark.parametrize(
    ("script", "result"), [(FOCUS, ["button", "body"]), (ARROWS, [True, False, False, False])], ids=["focus", "arrows"]
)
def test_habits(tmp_path: Path, script: str, result: list[object]) -> None:
    """After a click Space plays: no button gets the focus. Alt with an arrow goes back in the browser."""
    shutil.copy(STATIC / "habits.js", tmp_path)
    assert run(tmp_path, PAGE + script) == result


@needs_node
@pytest.mark.parametrize(
    ("file", "key"),
    [("viewport.js", "+"), ("timeline.js", "Home"), ("knob.js", "End"), ("outline_editor.js", "Delete")],
)
def test_a_key_with_a_modifier_is_left_to_the_browser(tmp_path: Path, file: str, key: str) -> None:
    view = tmp_path / "node_modules" / "hydrostat-view"
    view.mkdir(parents=True)
    (view / "index.js").write_text("export const View = null;")
    (view / "package.json").write_text('{"type": "module", "main": "index.js"}')
    shutil.copy(STATIC / file, tmp_path)
    assert run(tmp_path, PARTS, Path(file), Path(key)) == [[True, False, False, False], 1]
