"""The way to the server comes back when the other end has gone silent. Oracle: sockets that are opened, notes told."""

from pathlib import Path

from view_modules import needs_node, run

SCRIPT = """
import { mock } from "node:test";
mock.timers.enable({ apis: ["setTimeout"] });
const made = [], told = [];
globalThis.window = { location: { href: "http://192.168.1.20:8320/room/x" } };
globalThis.WebSocket = class {
  static OPEN = 1;
  readyState = 1;
  constructor() { made.push(this); setTimeout(() => this.onopen?.(), 1); }
  send() {}
  close() {}
};
const { Link } = await import("./view/link.js");
const link = new Link("/stream/x", () => {}, (connected) => told.push(connected));
const steps = [];
const note = () => steps.push([made.length, told.at(-1)]);
const wait = (time) => mock.timers.tick(time);
wait(10);
link.send({ kind: "seen" });
wait(60000); note();
link.send({ kind: "grab" });
made[0].onmessage({ data: new ArrayBuffer(0) });
wait(60000); note();
link.send({ kind: "grab" });
wait(9000); note();
wait(1100); note();
wait(1000); wait(10); note();
console.log(JSON.stringify(steps));
"""


@needs_node
def test_a_grab_without_an_answer_opens_the_way_again(tmp_path: Path) -> None:
    assert run(tmp_path, SCRIPT) == [[1, True], [1, True], [1, True], [1, False], [2, True]]
