// Faint squares behind a flat body, a round number of millimetres wide.

import { THREE } from "nicegui-scene";
import { rgb } from "./theme.js";

const MOST = 400;

export class Grid {
  constructor() {
    this.geometry = new THREE.BufferGeometry();
    this.place = new THREE.BufferAttribute(new Float32Array(6 * MOST), 3).setUsage(THREE.DynamicDrawUsage);
    this.geometry.setAttribute("position", this.place);
    this.tint = new THREE.Vector3();
    this.object = new THREE.LineSegments(this.geometry, new THREE.ShaderMaterial({
      vertexShader: "void main() { gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); }",
      fragmentShader: "uniform vec3 tint; void main() { gl_FragColor = vec4(tint, 1.0); }",
      uniforms: { tint: { value: this.tint } }, transparent: true, depthTest: false, depthWrite: false,
    }));
    this.object.frustumCulled = false;
    this.object.renderOrder = 0;
    this.objects = [this.object];
  }

  colour(theme) {
    this.tint.set(...rgb(theme.grid));
  }

  /** Fill what a camera sees. */
  move(camera) {
    this.object.visible = camera.flat;
    if (!camera.flat) return;
    const rough = 70 / camera.metre;
    const nice = Math.pow(10, Math.floor(Math.log10(rough)));
    const step = [1, 2, 5, 10].map((k) => k * nice).find((value) => value >= rough);
    const tall = camera.span / 2, wide = tall * (camera.width / camera.height);
    const { x, y } = camera.target, array = this.place.array;
    let count = 0;
    const add = (a, b, c, d) => {
      if (count < MOST) array.set([a, b, 0, c, d, 0], 6 * count++);
    };
    for (let k = Math.ceil((x - wide) / step); k * step < x + wide; k++) add(k * step, y - tall, k * step, y + tall);
    for (let k = Math.ceil((y - tall) / step); k * step < y + tall; k++) add(x - wide, k * step, x + wide, k * step);
    this.geometry.setDrawRange(0, 2 * count);
    this.place.needsUpdate = true;
  }

  dispose() {
    this.geometry.dispose();
    this.object.material.dispose();
  }
}
