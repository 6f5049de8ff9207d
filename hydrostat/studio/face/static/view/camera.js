// Where the body is looked at from. A flat body is looked at from above, without perspective.

import { THREE } from "nicegui-scene";

const OPENING = (28 * Math.PI) / 180;
const TURN = 220;
const VIEWS = { front: [0, 0], side: [Math.PI / 2, 0], top: [0, Math.PI / 2] };
const OBLIQUE = [-0.5, 0.3];

export class Camera {
  constructor() {
    this.perspective = new THREE.PerspectiveCamera((OPENING * 180) / Math.PI, 1, 0.01, 10);
    this.orthographic = new THREE.OrthographicCamera(-1, 1, 1, -1, 0.01, 10);
    this.flat = true;
    this.parallel = false;
    this.width = this.height = 100;
    this.target = new THREE.Vector3();
    this.span = 0.3; // how much of the world is seen from bottom to top, at the target [m]
    this.reach = 0.3; // radius of all that is shown [m]
    [this.azimuth, this.elevation] = VIEWS.top;
    this.moved = false;
    /** @type {{start: number, from: number[], to: number[]} | null} */
    this.turning = null;
    this.right = new THREE.Vector3();
    this.up = new THREE.Vector3();
    this.toward = new THREE.Vector3(); // from the target to the eye
    this.matrix = new THREE.Matrix4();
    /** @type {THREE.OrthographicCamera | THREE.PerspectiveCamera} */
    this.now = this.orthographic;
    this.place();
  }

  get meter() {
    return this.height / this.span; // pixels in a meter, at the target
  }

  begin(flat) {
    this.flat = flat;
    this.turning = null;
    [this.azimuth, this.elevation] = flat ? VIEWS.top : OBLIQUE;
    this.place();
  }

  /** What a person has moved to stays in view: all is drawn larger or smaller as the shorter side is. */
  resize(width, height) {
    const scale = this.meter / Math.min(this.width, this.height);
    this.width = Math.max(width, 1);
    this.height = Math.max(height, 1);
    if (this.moved) this.span = this.height / (scale * Math.min(this.width, this.height));
    this.place();
  }

  /** Set up the cameras; to be called after any change. */
  place() {
    const [ca, sa, ce, se] = [
      Math.cos(this.azimuth), Math.sin(this.azimuth), Math.cos(this.elevation), Math.sin(this.elevation),
    ];
    this.toward.set(sa * ce, -ca * ce, se);
    this.up.set(-sa * se, ca * se, ce);
    this.right.set(ca, sa, 0);
    const parallel = this.flat || this.parallel;
    const camera = parallel ? this.orthographic : this.perspective;
    const distance = parallel ? 4 * this.reach + this.span : this.span / 2 / Math.tan(OPENING / 2);
    camera.position.copy(this.target).addScaledVector(this.toward, distance);
    camera.up.copy(this.up);
    camera.lookAt(this.target);
    camera.near = parallel ? 0.01 * distance : Math.max(distance - 3 * this.reach, 0.02 * distance);
    camera.far = distance + 3 * this.reach;
    if (camera instanceof THREE.OrthographicCamera) {
      camera.top = this.span / 2;
      camera.bottom = -this.span / 2;
      camera.right = (this.span / 2) * (this.width / this.height);
      camera.left = -camera.right;
    } else {
      camera.aspect = this.width / this.height;
    }
    camera.updateProjectionMatrix();
    camera.updateMatrixWorld();
    this.now = camera;
    this.matrix.multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse);
  }

  /** Pixels from the top left of the view, and the depth, of a point. */
  project(x, y, z, out) {
    const e = this.matrix.elements;
    const w = e[3] * x + e[7] * y + e[11] * z + e[15];
    out[0] = ((e[0] * x + e[4] * y + e[8] * z + e[12]) / w + 1) * 0.5 * this.width;
    out[1] = (1 - (e[1] * x + e[5] * y + e[9] * z + e[13]) / w) * 0.5 * this.height;
    out[2] = (e[2] * x + e[6] * y + e[10] * z + e[14]) / w;
    return out;
  }

  /** Pixels in a meter at a point. */
  density(point) {
    if (this.flat || this.parallel) return this.meter;
    const depth = (point[0] - this.now.position.x) * this.toward.x + (point[1] - this.now.position.y) * this.toward.y
      + (point[2] - this.now.position.z) * this.toward.z;
    return this.height / (2 * Math.tan(OPENING / 2) * Math.max(-depth, 1e-6));
  }

  /** How much the depth of `project` changes over a small distance, at the target. */
  slack(distance) {
    const { near, far } = this.now;
    if (this.flat || this.parallel) return (2 * distance) / (far - near);
    const away = this.now.position.distanceTo(this.target);
    return (2 * distance * far * near) / ((far - near) * away * away);
  }

  /** The ray through a pixel: where it begins and its direction of length one. */
  ray(x, y) {
    const u = (x / this.width - 0.5) * this.span * (this.width / this.height);
    const v = (0.5 - y / this.height) * this.span;
    const through = this.target.clone().addScaledVector(this.right, u).addScaledVector(this.up, v);
    if (!this.flat && !this.parallel) {
      const origin = this.now.position.clone();
      return { origin, direction: through.sub(origin).normalize() };
    }
    return { origin: through.addScaledVector(this.toward, 4 * this.reach), direction: this.toward.clone().negate() };
  }

  /** Where the ray through a pixel meets the plane through a point that faces the camera. */
  facing(x, y, point) {
    const { origin, direction } = this.ray(x, y);
    const away = (point[0] - origin.x) * this.toward.x + (point[1] - origin.y) * this.toward.y
      + (point[2] - origin.z) * this.toward.z;
    const met = origin.addScaledVector(direction, away / direction.dot(this.toward));
    return [met.x, met.y, this.flat ? 0 : met.z];
  }

  zoom(x, y, factor) {
    const before = this.facing(x, y, this.target.toArray());
    const span = Math.min(Math.max(this.span * factor, 0.02 * this.reach), 20 * this.reach);
    const share = 1 - span / this.span;
    this.span = span;
    this.target.x += (before[0] - this.target.x) * share;
    this.target.y += (before[1] - this.target.y) * share;
    this.target.z += (before[2] - this.target.z) * share;
    this.changed();
  }

  pan(dx, dy) {
    this.target.addScaledVector(this.right, -dx / this.meter).addScaledVector(this.up, dy / this.meter);
    this.changed();
  }

  orbit(dx, dy) {
    this.azimuth -= 0.008 * dx;
    this.elevation = Math.min(Math.max(this.elevation + 0.008 * dy, -Math.PI / 2), Math.PI / 2);
    this.changed();
  }

  changed() {
    this.moved = true;
    this.turning = null;
    this.place();
  }

  /** Begin to turn to a view; `turn` goes on with it. `fit` is called with the camera as it will be in the end. */
  look(name, now, fit = () => {}) {
    if (this.flat || !(name in VIEWS)) return;
    const [azimuth, elevation] = VIEWS[name];
    const from = this.pose();
    this.azimuth = azimuth + 2 * Math.PI * Math.round((this.azimuth - azimuth) / (2 * Math.PI));
    this.elevation = elevation;
    this.place();
    fit();
    this.turning = { start: now, from, to: this.pose() };
    this.stand(from);
  }

  pose() {
    return [this.azimuth, this.elevation, this.span, ...this.target.toArray()];
  }

  stand(pose) {
    [this.azimuth, this.elevation, this.span] = pose;
    this.target.fromArray(pose, 3);
    this.place();
  }

  /** Go on turning; whether there is more to do. */
  turn(now) {
    if (!this.turning) return false;
    const { start, from, to } = this.turning;
    const share = Math.min(Math.max((now - start) / TURN, 0), 1);
    const smooth = share * share * (3 - 2 * share);
    this.stand(share === 1 ? to : from.map((value, i) => value + smooth * (to[i] - value)));
    if (share === 1) this.turning = null;
    return share < 1;
  }

  /** Show all of some points; `margin` is kept free at the sides, in pixels [left, top, right, bottom]. */
  fit(tables, margin) {
    const middle = new THREE.Vector3();
    const box = new THREE.Box3();
    for (const table of tables) {
      for (let i = 0; i + 2 < table.length; i += 3) box.expandByPoint(middle.set(table[i], table[i + 1], table[i + 2]));
    }
    if (box.isEmpty()) return;
    box.getCenter(middle);
    this.reach = Math.max(box.getSize(new THREE.Vector3()).length() / 2, 1e-4);
    this.target.copy(middle);
    this.span = 3 * this.reach;
    const [left, top, right, bottom] = margin;
    const wide = Math.max(this.width - left - right, 40), tall = Math.max(this.height - top - bottom, 40);
    const spot = [0, 0, 0];
    // with perspective, what is seen of a thing depends on where one stands: a few steps come near enough
    for (let step = 0; step < (this.flat || this.parallel ? 1 : 4); step++) {
      this.place();
      const low = [Infinity, Infinity], high = [-Infinity, -Infinity];
      for (const table of tables) {
        for (let i = 0; i + 2 < table.length; i += 3) {
          this.project(table[i], table[i + 1], table[i + 2], spot);
          for (const k of [0, 1]) {
            low[k] = Math.min(low[k], spot[k]);
            high[k] = Math.max(high[k], spot[k]);
          }
        }
      }
      const size = Math.max((high[0] - low[0]) / wide, (high[1] - low[1]) / tall, 1e-6);
      const u = (low[0] + high[0] - this.width) / 2, v = (this.height - low[1] - high[1]) / 2;
      this.target.addScaledVector(this.right, (u + (size * (right - left)) / 2) / this.meter)
        .addScaledVector(this.up, (v + (size * (top - bottom)) / 2) / this.meter);
      this.span *= size;
    }
    this.moved = false;
    this.place();
  }
}
