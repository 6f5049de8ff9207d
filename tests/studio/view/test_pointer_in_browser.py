"""What the pointer tells the server. Oracle: the server's own reader of messages."""

import json
from pathlib import Path

import pytest
from view_modules import needs_node, run

from hydrostat.studio.face.messages import LetGo, Pointer, read_message

SCRIPT = """
const ears = {};
const listen = { addEventListener: (name, ear) => (ears[name] = ear), removeEventListener() {} };
globalThis.window = listen;
const { Camera } = await import("./view/camera.js");
const { Pointer } = await import("./view/pointer.js");
const table = (...numbers) => new Float32Array(numbers);
const camera = new Camera();
camera.resize(400, 400);
camera.fit([table(-0.1, -0.1, 0, 0.1, 0.1, 0)], [100, 100, 100, 100]);
const square = table(-0.1, -0.1, 0, 0.1, -0.1, 0, 0.1, 0.1, 0, -0.1, 0.1, 0);
const tip = { key: "marker:tip", look: "marker", x: 250, y: 200, depth: 0, place: [0.05, 0, 0] };
const view = {
  element: { ...listen, setPointerCapture() {}, getBoundingClientRect: () => ({ left: 10, top: 20 }) },
  camera, nodes: square, rest: square, faces: new Uint32Array([0, 1, 2, 0, 2, 3]), points: table(),
  dots: [tip], lines: [], areas: [], brush: false, sent: [],
  send(message) { this.sent.push(message); },
  mark() {},
};
const pointer = new Pointer(view);
let time = 1000;
const event = (x, y, more) => ({
  clientX: x + 10, clientY: y + 20, pointerId: 1, button: 0, pointerType: "mouse", shiftKey: false, timeStamp: time++,
  preventDefault() {}, ...more,
});
const down = (x, y, more) => ears.pointerdown(event(x, y, more));
const move = (x, y) => ears.pointermove(event(x, y));
const up = (x, y) => ears.pointerup(event(x, y));
const found = {};
const part = (name, ...steps) => {
  view.sent = [];
  pointer.tick();
  for (const step of steps) step();
  found[name] = view.sent;
};
part("click", () => down(250, 200, { shiftKey: true }), () => move(252, 200), () => up(252, 200));
part("drag", () => down(150, 200), () => { for (let x = 160; x <= 230; x += 10) move(x, 200); }, () => pointer.tick(),
  () => move(350, 200), () => up(350, 200));
const target = camera.target.x;
part("beside", () => down(20, 20), () => move(60, 20), () => up(60, 20));
found.panned = target - camera.target.x;
found.meter = camera.meter;
view.brush = true;
part("brush", () => down(20, 20), () => move(60, 20), () => up(60, 20));
view.brush = false;
const ends = {
  escape: () => ears.keydown({ key: "Escape" }), blur: () => ears.blur(), cancel: () => ears.pointercancel(event(0, 0)),
};
for (const [name, end] of Object.entries(ends))
  part(name, () => down(200, 200), () => move(230, 200), end, () => move(250, 200), () => up(250, 200));
console.log(JSON.stringify(found));
"""


@needs_node
def test_pointer(tmp_path: Path) -> None:
    found = run(tmp_path, SCRIPT)
    told = {
        name: [read_message(json.dumps(message)) for message in messages]
        for name, messages in found.items()
        if isinstance(messages, list)
    }

    (click,) = told["click"]
    assert isinstance(click, Pointer)
    assert (click.kind, click.key, click.shift) == ("click", "marker:tip", True)

    assert [message.kind for message in told["drag"]] == ["grab", "drag", "drag", "drag", "release"]
    grab, *drags, _ = told["drag"]
    assert isinstance(grab, Pointer)
    assert grab.key == "body"
    assert grab.rest == pytest.approx(grab.world, abs=1e-9)
    # one at once, the newest of the others with the next animation frame, the last before the end
    spots = [grab, *(drag for drag in drags if isinstance(drag, Pointer))]
    places = [200 + spot.world[0] * found["meter"] for spot in spots]
    assert [round(place) for place in places] == [150, 160, 230, 350]
    assert spots[-1].rest is None
    assert [spot.stamp for spot in spots] == sorted(spot.stamp for spot in spots)

    assert told["beside"] == []
    assert round(found["panned"] * found["meter"]) == 40
    assert [message.kind for message in told["brush"]] == ["grab", "drag", "release"]
    for name in ("escape", "blur", "cancel"):
        assert [message.kind for message in told[name]] == ["grab", "drag", "release"]
        assert isinstance(told[name][-1], LetGo)
