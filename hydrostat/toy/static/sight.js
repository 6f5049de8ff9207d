// From places of the robot [m] to pixels of the canvas, and back.

export class Sight {
  /** @param {{dim: number, up: number[], eye: number[], points: Float64Array, size: number}} facts */
  constructor({ dim, up, eye, points, size }) {
    this.dim = dim;
    this.up = up;
    const side = Math.abs(up[0]) < 0.9 ? [1, 0, 0] : [0, 1, 0];
    this.level = [unit(cross(up, side))];
    this.level.push(cross(up, this.level[0]));
    const right = cross(up, eye);
    this.yaw = Math.atan2(product(right, this.level[1]), product(right, this.level[0]));
    this.pitch = Math.asin(Math.max(-1, Math.min(1, product(eye, up))));
    this.zoom = 1;
    this.width = this.height = this.scale = 1;
    this.middle = [0, 1, 2].slice(0, dim).map((axis) => {
      let low = Infinity, high = -Infinity;
      for (let i = axis; i < points.length; i += dim) {
        low = Math.min(low, points[i]);
        high = Math.max(high, points[i]);
      }
      return { middle: (low + high) / 2, span: high - low };
    });
    this.size = size;
    this.turn();
    this.spans = [0, 1].map((axis) => {
      const seen = Array.from({ length: points.length / dim }, (_, i) => this.see(points, dim * i)[axis]);
      return Math.max(...seen.map((value) => 2 * Math.abs(value - 0.5)));
    });
  }

  /** Axes to the right, up and towards the eye. */
  turn() {
    if (this.dim === 2) {
      this.axes = [[1, 0], [0, 1]];
      return;
    }
    const up = this.up, [one, two] = this.level;
    const right = one.map((value, i) => Math.cos(this.yaw) * value + Math.sin(this.yaw) * two[i]), front = cross(right, up);
    const near = front.map((value, i) => Math.cos(this.pitch) * value + Math.sin(this.pitch) * up[i]);
    this.axes = [right, cross(near, right), near];
  }

  /** Fit to a canvas of some size [pixels]; room for motion is left on all sides. */
  fit(width, height) {
    this.width = width;
    this.height = height;
    this.scale = this.zoom * Math.min(width / (1.3 * this.spans[0]), height / (1.25 * this.spans[1]));
  }

  /** Pixels and depth of a point, which begins at a place of an array. */
  see(points, at) {
    const [right, up, near] = this.axes;
    let [x, y, depth] = [0, 0, 0];
    for (let i = 0; i < this.dim; i++) {
      const far = points[at + i] - this.middle[i].middle;
      x += right[i] * far;
      y += up[i] * far;
      if (near) depth += near[i] * far;
    }
    return [this.width / 2 + this.scale * x, this.height / 2 - this.scale * y, depth];
  }

  /** Place [m] of pixels, as far away as a point. */
  place(x, y, like) {
    const [nowX, nowY] = this.see(like, 0);
    const right = (x - nowX) / this.scale, up = (nowY - y) / this.scale;
    return Array.from(like, (value, i) => value + right * this.axes[0][i] + up * this.axes[1][i]);
  }
}

function cross(a, b) {
  return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
}

function product(a, b) {
  return a.reduce((sum, value, i) => sum + value * b[i], 0);
}

function unit(a) {
  const length = Math.hypot(...a);
  return a.map((value) => value / length);
}
