// From the pointer's events to what is told to the server, or to a turn of the camera.

import { pick, bodyAt } from "./pick.js";

const STILL = 3;

export class Pointer {
  /** @param view the View whose element is listened to */
  constructor(view) {
    this.view = view;
    this.element = view.element;
    this.press = null; // what is going on between down and up
    this.touches = new Map();
    this.at = null; // where the pointer hovers
    this.waiting = null; // a drag that waits for the next animation frame
    this.quiet = false; // whether one was sent in this animation frame
    this.ears = [
      [this.element, "pointerdown", this.down], [this.element, "pointermove", this.move], [this.element, "pointerup", this.up],
      [this.element, "pointercancel", this.lost], [this.element, "lostpointercapture", this.lost],
      [this.element, "pointerleave", this.leave], [this.element, "wheel", this.wheel],
      [this.element, "contextmenu", (event) => event.preventDefault()],
      [window, "blur", () => this.cancel()],
      [window, "keydown", (event) => event.key === "Escape" && this.cancel()],
    ].map(([target, name, ear]) => [target, name, ear.bind(this)]);
    for (const [target, name, ear] of this.ears) target.addEventListener(name, ear, { passive: false });
  }

  dispose() {
    for (const [target, name, ear] of this.ears) target.removeEventListener(name, ear);
  }

  place(event) {
    const box = this.element.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  }

  down(event) {
    const [x, y] = this.place(event);
    this.touches.set(event.pointerId, [x, y]);
    if (event.pointerType === "touch" && this.touches.size === 2) {
      this.cancel();
      this.press = { mode: "pinch" };
      return;
    }
    if (this.press) return;
    this.element.setPointerCapture(event.pointerId);
    const { view } = this;
    const press = { id: event.pointerId, x, y, last: [x, y], mode: "still", shift: event.shiftKey };
    this.press = press;
    if (event.button === 0) {
      press.hit = pick(view, x, y);
      press.holds = press.hit.key !== "" || view.brush;
      press.turn = view.camera.flat ? "pan" : "orbit";
    } else {
      press.mode = event.button === 1 || event.shiftKey || view.camera.flat ? "pan" : "orbit";
      event.preventDefault();
    }
  }

  move(event) {
    const [x, y] = this.place(event);
    this.at = [x, y];
    if (this.touches.has(event.pointerId)) {
      if (this.press?.mode === "pinch") return this.pinch(event.pointerId, x, y);
      this.touches.set(event.pointerId, [x, y]);
    }
    const { press, view } = this;
    if (!press) return view.mark("hover");
    if (press.id !== event.pointerId) return;
    if (press.mode === "still") {
      if (Math.hypot(x - press.x, y - press.y) <= STILL) return;
      if (press.holds) {
        press.mode = "hold";
        this.say("grab", press.hit, event);
      } else {
        press.mode = press.turn;
      }
    }
    const [dx, dy] = [x - press.last[0], y - press.last[1]];
    press.last = [x, y];
    if (press.mode === "pan") view.camera.pan(dx, dy);
    else if (press.mode === "orbit") view.camera.orbit(dx, dy);
    else return this.drag(x, y, event);
    view.mark("camera");
  }

  up(event) {
    this.touches.delete(event.pointerId);
    const { press } = this;
    if (press?.mode === "pinch") {
      if (!this.touches.size) this.press = null;
      return;
    }
    if (!press || press.id !== event.pointerId) return;
    this.press = null;
    if (press.mode === "still" && press.hit) this.say("click", press.hit, event, press.shift);
    if (press.mode === "hold") this.release();
    this.view.mark("hover");
  }

  lost(event) {
    this.touches.delete(event.pointerId);
    if (this.press && (this.press.id === event.pointerId || this.press.mode === "pinch")) this.cancel();
  }

  leave() {
    this.at = null;
    this.view.mark("hover");
  }

  wheel(event) {
    event.preventDefault();
    const unit = event.deltaMode === 1 ? 30 : event.deltaMode === 2 ? 300 : 1;
    const turned = Math.min(Math.max(event.deltaY * unit, -300), 300);
    this.view.camera.zoom(...this.place(event), Math.exp(0.0015 * turned));
    this.view.mark("camera");
  }

  pinch(id, x, y) {
    const others = [...this.touches.entries()].filter(([other]) => other !== id);
    const before = this.touches.get(id);
    this.touches.set(id, [x, y]);
    if (!others.length) return;
    const [, other] = others[0];
    const apart = (spot) => Math.max(Math.hypot(spot[0] - other[0], spot[1] - other[1]), 1);
    const { camera } = this.view;
    camera.pan((x - before[0]) / 2, (y - before[1]) / 2);
    camera.zoom((x + other[0]) / 2, (y + other[1]) / 2, apart(before) / apart([x, y]));
    this.view.mark("camera");
  }

  drag(x, y, event) {
    const { view, press } = this;
    const body = bodyAt(view, x, y);
    const hit = { key: press.hit.key, rest: body && body.rest, world: view.camera.facing(x, y, press.hit.world) };
    this.waiting = [hit, event.timeStamp, event.shiftKey];
    if (this.quiet) return view.mark("drag");
    this.flush();
  }

  /** A new animation frame has begun: what waited may be sent. */
  tick() {
    this.quiet = false;
    if (this.waiting) this.flush();
  }

  flush() {
    const [hit, stamp, shift] = this.waiting;
    this.waiting = null;
    this.quiet = true;
    this.view.send(message("drag", hit, stamp, shift));
    this.view.mark("drag"); // an animation frame will come that calls tick
  }

  say(kind, hit, event, shift = event.shiftKey) {
    this.view.send(message(kind, hit, event.timeStamp, shift));
  }

  release() {
    if (this.waiting) this.flush();
    this.view.send({ kind: "release" });
  }

  /** Let go of everything, as if the button were up. */
  cancel() {
    const { press } = this;
    this.press = null;
    this.waiting = null;
    if (press?.mode === "hold") this.release();
    this.view.mark("hover");
  }
}

function message(kind, { key, rest, world }, stamp, shift) {
  return { kind, key, rest, world, shift, stamp };
}
