// Lines of a width in pixels: each segment is a strip that turns to the camera, with round ends.

import { THREE } from "nicegui-scene";
import { rgb } from "./theme.js";

const VERTEX = `
attribute vec3 start;
attribute vec3 end;
attribute vec4 tint;
attribute vec4 look; // width, dash, gap in pixels; layer
attribute vec3 run;  // length of the line before and after the segment [m]; whether it only lies under another
uniform vec2 size;
uniform float ratio;
uniform float metre;
varying vec2 place;
varying vec4 colour;
varying vec3 shape;
varying vec2 dash;
varying float before;
varying float under;
void main() {
  vec4 a = projectionMatrix * modelViewMatrix * vec4(start, 1.0);
  vec4 b = projectionMatrix * modelViewMatrix * vec4(end, 1.0);
  vec2 from = 0.5 * size * a.xy / a.w;
  vec2 to = 0.5 * size * b.xy / b.w;
  float far = length(to - from);
  vec2 along = far > 1e-4 ? (to - from) / far : vec2(1.0, 0.0);
  vec2 across = vec2(-along.y, along.x);
  float half_width = 0.5 * look.x * ratio;
  float reach = half_width + 1.0;
  float side = position.x;
  vec2 spot = mix(from - along * reach, to + along * reach, side) + across * position.y * reach;
  vec4 clip = mix(a, b, side);
  gl_Position = vec4(spot / (0.5 * size) * clip.w, clip.z - 0.0003 * look.w * clip.w, clip.w);
  place = vec2(mix(-reach, far + reach, side), position.y * reach);
  colour = tint;
  shape = vec3(far, half_width, look.x);
  dash = look.yz * ratio;
  under = run.z;
  before = run.x * metre * ratio;
}`;

const FRAGMENT = `
uniform float fade;
uniform float bare;
varying float under;
varying vec2 place;
varying vec4 colour;
varying vec3 shape;
varying vec2 dash;
varying float before;
void main() {
  float beyond = max(max(-place.x, place.x - shape.x), 0.0);
  if ((dash.x > 0.0 && beyond > 0.0) || (bare > 0.5 && under > 0.5)) discard;
  float alpha = clamp(shape.y - length(vec2(beyond, place.y)) + 0.5, 0.0, 1.0);
  if (dash.x > 0.0) {
    float at = mod(before + place.x, dash.x + dash.y);
    alpha *= clamp(min(at, dash.x - at) + 0.5, 0.0, 1.0);
  }
  alpha *= colour.a * fade;
  if (alpha < 0.01) discard;
  gl_FragColor = vec4(colour.rgb, alpha);
}`;

function material(uniforms, options) {
  return new THREE.ShaderMaterial({
    vertexShader: VERTEX, fragmentShader: FRAGMENT, uniforms, transparent: true, depthTest: true, depthWrite: true, ...options,
  });
}

export class Strokes {
  /** @param {boolean} flat whether lines are painted one over the other, without depth */
  constructor(flat) {
    this.flat = flat;
    const shared = { size: { value: new THREE.Vector2(1, 1) }, ratio: { value: 1 }, metre: { value: 1 } };
    this.uniforms = { ...shared, fade: { value: 1 }, bare: { value: 0 } };
    this.hidden = { ...shared, fade: { value: 0.4 }, bare: { value: 1 } };
    this.geometry = new THREE.InstancedBufferGeometry();
    this.geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array([0, -1, 0, 1, -1, 0, 1, 1, 0, 0, 1, 0]), 3));
    this.geometry.setIndex([0, 1, 2, 0, 2, 3]);
    this.mesh = new THREE.Mesh(this.geometry, material(this.uniforms, flat ? { depthTest: false, depthWrite: false } : {}));
    this.behind = new THREE.Mesh(this.geometry, material(this.hidden, {
      // behind the body, and each pixel once, so that joints are not darker
      depthFunc: THREE.GreaterDepth, depthWrite: false, stencilWrite: true, stencilFunc: THREE.EqualStencilFunc,
      stencilRef: 0, stencilZPass: THREE.IncrementStencilOp,
    }));
    this.mesh.frustumCulled = this.behind.frustumCulled = false;
    this.behind.visible = !flat;
    this.objects = [this.mesh, this.behind];
    this.lay([]);
  }

  /**
   * Say which lines there are.
   * @param lines {source: name of a table, points: indices in it, width, colour, opacity, dash: [on, off], layer,
   *   under: whether it is left out behind the body}
   */
  lay(lines) {
    this.lines = [...lines].sort((a, b) => a.layer - b.layer);
    const count = this.lines.reduce((sum, line) => sum + Math.max(line.points.length - 1, 0), 0);
    const wide = { start: 3, end: 3, tint: 4, look: 4, run: 3 };
    for (const [name, columns] of Object.entries(wide)) {
      const attribute = new THREE.InstancedBufferAttribute(new Float32Array(columns * Math.max(count, 1)), columns);
      attribute.setUsage(THREE.DynamicDrawUsage);
      this.geometry.setAttribute(name, attribute);
      this[name] = attribute;
    }
    this.geometry.instanceCount = count;
    this.geometry._maxInstanceCount = undefined;
    let first = 0;
    for (const line of this.lines) {
      line.first = first;
      first += Math.max(line.points.length - 1, 0);
      this.paint(line, line.width, line.colour);
    }
    this.mesh.visible = count > 0;
    this.behind.visible = count > 0 && !this.flat;
  }

  /** Width and colour of a line from now on. */
  paint(line, width, colour) {
    const [r, g, b] = rgb(colour);
    const [on, off] = line.dash ?? [0, 0];
    const layer = this.flat ? 0 : line.layer;
    for (let i = line.first; i < line.first + line.points.length - 1; i++) {
      this.tint.array.set([r, g, b, line.opacity ?? 1], 4 * i);
      this.look.array.set([width, on, off, layer], 4 * i);
    }
    this.tint.needsUpdate = this.look.needsUpdate = true;
  }

  /** Move all lines to where the tables say. */
  move(tables) {
    const start = this.start.array, end = this.end.array, run = this.run.array;
    for (const line of this.lines) {
      const table = tables[line.source];
      if (!table) continue;
      let length = 0;
      for (let k = 0; k + 1 < line.points.length; k++) {
        const i = 3 * line.points[k], j = 3 * line.points[k + 1], at = 3 * (line.first + k);
        start[at] = table[i]; start[at + 1] = table[i + 1]; start[at + 2] = table[i + 2];
        end[at] = table[j]; end[at + 1] = table[j + 1]; end[at + 2] = table[j + 2];
        const next = length + Math.hypot(table[j] - table[i], table[j + 1] - table[i + 1], table[j + 2] - table[i + 2]);
        run[at] = length;
        run[at + 1] = next;
        run[at + 2] = line.under ? 1 : 0;
        length = next;
      }
    }
    this.start.needsUpdate = this.end.needsUpdate = this.run.needsUpdate = true;
  }

  dispose() {
    this.geometry.dispose();
    this.mesh.material.dispose();
    this.behind.material.dispose();
  }
}
