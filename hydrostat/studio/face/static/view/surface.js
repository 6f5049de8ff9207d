// What WebGL draws: the surface of a body in space, of felt or colored by values.

import { THREE } from "nicegui-scene";
import { rgb } from "./theme.js";

const VERTEX = `
attribute float value;
varying vec3 facing;
varying vec3 toward;
varying vec3 world;
varying float share;
void main() {
  vec4 seen = modelViewMatrix * vec4(position, 1.0);
  facing = normalMatrix * normal;
  toward = projectionMatrix[3][3] == 1.0 ? vec3(0.0, 0.0, 1.0) : -seen.xyz;
  world = position;
  share = value;
  gl_Position = projectionMatrix * seen;
}`;

const CUT = `
varying vec3 world;
uniform vec4 cut; // what lies beyond this plane is not shown
`;

const FELT = `
varying vec3 facing;
varying vec3 toward;
varying float share;
uniform vec3 felt;
uniform vec3 light;
uniform vec3 seam;
uniform vec3 inside;
uniform float colored;
uniform float opacity;
uniform sampler2D ramp;
${CUT}
void main() {
  if (dot(world, cut.xyz) > cut.w) discard;
  vec3 base = texture2D(ramp, vec2(clamp(share, 0.0, 1.0) * 0.996 + 0.002, 0.5)).rgb;
  vec3 n = normalize(facing);
  vec3 eye = normalize(toward);
  float edge = 1.0 - abs(dot(n, eye));
  float bright = 0.5 + 0.5 * dot(n, vec3(-0.38, 0.62, 0.686));
  if (!gl_FrontFacing) {
    gl_FragColor = vec4(inside * (1.0 - 0.22 * bright), 1.0);
    return;
  }
  vec3 wool = mix(mix(seam, felt, smoothstep(-0.15, 0.62, bright)), light, 0.9 * smoothstep(0.5, 1.0, bright));
  wool = mix(wool, seam, 0.62 * edge * edge * edge);
  vec3 data = base * (0.66 + 0.4 * bright) * (1.0 - 0.25 * edge * edge * edge);
  gl_FragColor = vec4(mix(wool, data, colored), opacity);
}`;

const DEPTH = `
${CUT}
void main() {
  if (dot(world, cut.xyz) > cut.w) discard;
  gl_FragColor = vec4(1.0);
}`;

function smooth(position, faces, normal) {
  normal.fill(0);
  for (let f = 0; f < faces.length; f += 3) {
    const a = 3 * faces[f], b = 3 * faces[f + 1], c = 3 * faces[f + 2];
    const ux = position[b] - position[a], uy = position[b + 1] - position[a + 1], uz = position[b + 2] - position[a + 2];
    const vx = position[c] - position[a], vy = position[c + 1] - position[a + 1], vz = position[c + 2] - position[a + 2];
    // in squared millimeters, so that they are far from the smallest numbers
    const x = 1e6 * (uy * vz - uz * vy), y = 1e6 * (uz * vx - ux * vz), z = 1e6 * (ux * vy - uy * vx);
    normal[a] += x; normal[a + 1] += y; normal[a + 2] += z;
    normal[b] += x; normal[b + 1] += y; normal[b + 2] += z;
    normal[c] += x; normal[c + 1] += y; normal[c + 2] += z;
  }
}

function surface(rest, faces) {
  const geometry = new THREE.BufferGeometry();
  for (const [name, columns] of Object.entries({ position: 3, normal: 3, value: 1 })) {
    const attribute = new THREE.BufferAttribute(new Float32Array((rest.length / 3) * columns), columns);
    geometry.setAttribute(name, attribute.setUsage(THREE.DynamicDrawUsage));
  }
  geometry.attributes.position.array.set(rest);
  geometry.setIndex(new THREE.BufferAttribute(faces, 1));
  smooth(rest, faces, geometry.attributes.normal.array);
  return geometry;
}

function shown(geometry, material, order) {
  const mesh = new THREE.Mesh(geometry, material);
  mesh.frustumCulled = false;
  mesh.renderOrder = order;
  return mesh;
}

export class Surface {
  constructor(rest, faces, ramp, order) {
    this.faces = faces;
    this.geometry = surface(rest, faces);
    const texture = new THREE.DataTexture(ramp, 256, 1);
    texture.magFilter = texture.minFilter = THREE.LinearFilter;
    texture.needsUpdate = true;
    this.uniforms = {
      felt: { value: new THREE.Vector3() }, light: { value: new THREE.Vector3() }, seam: { value: new THREE.Vector3() },
      inside: { value: new THREE.Vector3() }, colored: { value: 0 }, opacity: { value: 1 }, ramp: { value: texture },
      cut: { value: new THREE.Vector4(0, 0, 0, 1) },
    };
    const own = { vertexShader: VERTEX, uniforms: this.uniforms, transparent: true };
    this.before = shown(this.geometry, new THREE.ShaderMaterial({ ...own, fragmentShader: DEPTH, colorWrite: false }), order);
    this.body = shown(this.geometry, new THREE.ShaderMaterial({ ...own, fragmentShader: FELT }), order + 1);
    this.objects = [this.before, this.body];
    this.see(1);
  }

  color(palette, inside) {
    this.uniforms.felt.value.set(...rgb(palette.felt));
    this.uniforms.light.value.set(...rgb(palette.felt_light));
    this.uniforms.seam.value.set(...rgb(palette.seam));
    this.uniforms.inside.value.set(...rgb(inside));
  }

  move(nodes, values) {
    const { position, normal, value } = this.geometry.attributes;
    position.array.set(nodes);
    smooth(nodes, this.faces, normal.array);
    position.needsUpdate = normal.needsUpdate = true;
    this.uniforms.colored.value = values ? 1 : 0;
    if (values) {
      value.array.set(values);
      value.needsUpdate = true;
    }
  }

  /** See through the body, from 0 to 1 (not at all). */
  see(opacity) {
    this.uniforms.opacity.value = opacity;
    this.before.visible = opacity < 1;
  }

  /** Show only one side of a plane: [x, y, z, share]; null for all. */
  section(plane) {
    const [x, y, z, share] = plane ?? [0, 0, 0, 1];
    this.uniforms.cut.value.set(x, y, z, share);
    const side = plane ? THREE.DoubleSide : THREE.FrontSide;
    for (const mesh of [this.before, this.body]) {
      if (mesh.material.side !== side) mesh.material.needsUpdate = true;
      mesh.material.side = side;
    }
  }

  dispose() {
    this.uniforms.ramp.value.dispose();
    this.geometry.dispose();
    for (const object of this.objects) object.material.dispose();
  }
}
