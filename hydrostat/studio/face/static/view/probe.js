// What tests and benchmarks may look at: window.__app.

const KEPT = 2000;

export class Probe {
  constructor(view) {
    this.view = view;
    this.connected = false;
    this.scenes = this.frames = this.painted = this.stamp = 0;
    /** @type {number[]} */
    this.latencies = [];
    /** @type {number[]} */
    this.paints = [];
    /** @type {string[]} */
    this.errors = [];
  }

  /** Dots with a key: [{key, x, y}], in pixels of the window. */
  get items() {
    const box = this.view.element.getBoundingClientRect();
    return this.view.dots.filter((dot) => dot.key).map(({ key, x, y }) => ({ key, x: box.left + x, y: box.top + y }));
  }

  /** Where the node nearest to a place in the rest shape is, in pixels of the window. */
  body(x, y, z = 0) {
    const { rest, nodes, camera, element } = this.view;
    let best = 0, least = Infinity;
    for (let i = 0; i < rest.length; i += 3) {
      const far = (rest[i] - x) ** 2 + (rest[i + 1] - y) ** 2 + (rest[i + 2] - z) ** 2;
      if (far < least) [best, least] = [i, far];
    }
    const box = element.getBoundingClientRect();
    const [u, v] = camera.project(nodes[best], nodes[best + 1], nodes[best + 2], [0, 0, 0]);
    return { x: box.left + u, y: box.top + v };
  }

  /** A frame is on the screen. */
  saw(stamp, took) {
    this.painted += 1;
    keep(this.paints, took);
    if (stamp > this.stamp) {
      this.stamp = stamp;
      keep(this.latencies, performance.now() - stamp);
    }
  }
}

function keep(list, value) {
  list.push(value);
  if (list.length > KEPT) list.shift();
}
