// Values of the nodes of a flat body as a field of colors.

import { rgb } from "./theme.js";

const CELL = 2; // so many pixels of the view have one color; it is smoothed when it is drawn

/** A row of colors as 256 colors, each four bytes. */
export function ramp256(colors) {
  const bytes = new Uint8Array(4 * 256);
  for (let i = 0; i < 256; i++) {
    const place = (i / 255) * (colors.length - 1);
    const first = Math.min(Math.floor(place), colors.length - 2);
    const [a, b] = [rgb(colors[first]), rgb(colors[first + 1])];
    for (let k = 0; k < 3; k++) bytes[4 * i + k] = Math.round(255 * (a[k] + (place - first) * (b[k] - a[k])));
    bytes[4 * i + 3] = 255;
  }
  return bytes;
}

/** Nodes with those of the rim moved out a little, so that the field reaches the smooth rim that cuts it off. */
function widened(nodes, loops) {
  const wide = new Float32Array(nodes);
  for (const loop of loops) {
    for (let i = 0; i < loop.length; i++) {
      const a = 3 * loop[(i + loop.length - 1) % loop.length], b = 3 * loop[(i + 1) % loop.length], at = 3 * loop[i];
      wide[at] += 0.15 * (nodes[b + 1] - nodes[a + 1]);
      wide[at + 1] -= 0.15 * (nodes[b] - nodes[a]);
    }
  }
  return wide;
}

export class Field {
  /** @param ramp 256 colors as bytes */
  constructor(ramp) {
    this.colors = new Uint32Array(ramp.buffer);
    this.canvas = document.createElement("canvas");
    this.pen = this.canvas.getContext("2d", { willReadFrequently: true });
  }

  /** Draw the values of a view's body, within what the pen is clipped to. */
  draw(pen, view) {
    const { camera, faces, values } = view;
    const wide = Math.ceil(camera.width / CELL), tall = Math.ceil(camera.height / CELL);
    if (this.canvas.width !== wide || this.canvas.height !== tall) {
      [this.canvas.width, this.canvas.height] = [wide, tall];
      this.image = this.pen.createImageData(wide, tall);
      this.pixels = new Uint32Array(this.image.data.buffer);
    }
    this.pixels.fill(0);
    const nodes = widened(view.nodes, view.skin.loops);
    const meter = camera.meter / CELL, left = camera.target.x - wide / 2 / meter, top = camera.target.y + tall / 2 / meter;
    const x = (node) => (nodes[3 * node] - left) * meter - 0.5, y = (node) => (top - nodes[3 * node + 1]) * meter - 0.5;
    for (let f = 0; f < faces.length; f += 3) {
      const a = faces[f], b = faces[f + 1], c = faces[f + 2];
      this.triangle(wide, tall, x(a), y(a), values[a], x(b), y(b), values[b], x(c), y(c), values[c]);
    }
    this.pen.putImageData(this.image, 0, 0);
    pen.drawImage(this.canvas, 0, 0, wide * CELL, tall * CELL);
  }

  triangle(wide, tall, ax, ay, va, bx, by, vb, cx, cy, vc) {
    const ux = bx - ax, uy = by - ay, vx = cx - ax, vy = cy - ay;
    const whole = ux * vy - uy * vx;
    if (!whole) return;
    const { pixels, colors } = this;
    const first = Math.max(Math.ceil(Math.min(ay, by, cy) - 0.5), 0);
    const last = Math.min(Math.floor(Math.max(ay, by, cy) + 0.5), tall - 1);
    const from = Math.max(Math.ceil(Math.min(ax, bx, cx) - 0.5), 0);
    const to = Math.min(Math.floor(Math.max(ax, bx, cx) + 0.5), wide - 1);
    const near = -0.02; // a little over the edges, so that no gap is between triangles
    for (let row = first; row <= last; row++) {
      for (let column = from; column <= to; column++) {
        const s = ((column - ax) * vy - (row - ay) * vx) / whole;
        const t = (ux * (row - ay) - uy * (column - ax)) / whole;
        if (s < near || t < near || s + t > 1 - near) continue;
        const value = va + s * (vb - va) + t * (vc - va);
        pixels[row * wide + column] = colors[value <= 0 ? 0 : value >= 1 ? 255 : Math.round(255 * value)];
      }
    }
  }
}
