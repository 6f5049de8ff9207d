// The skin of a body in space, by WebGL: felt in soft light. Without WebGL its points are dots of the canvas above.

const VERTEX = `
attribute vec3 place; attribute vec3 normal;
uniform mat3 axes; uniform vec3 middle; uniform vec3 scale;
varying vec3 way;
void main() {
  vec3 seen = (place - middle) * axes;
  way = normal * axes;
  gl_Position = vec4(seen.x * scale.x, seen.y * scale.y, -seen.z * scale.z, 1.0);
}`;
const FRAGMENT = `
precision mediump float;
varying vec3 way;
void main() {
  vec3 n = normalize(way);
  float light = 0.5 + 0.5 * dot(n, normalize(vec3(-0.4, 0.75, 0.55)));
  vec3 felt = mix(vec3(0.62, 0.40, 0.26), vec3(0.96, 0.80, 0.67), smoothstep(0.0, 1.0, light));
  felt *= 0.82 + 0.18 * smoothstep(0.0, 0.5, n.z);
  gl_FragColor = vec4(felt, 1.0);
}`;

export class Surface {
  /**
   * @param {HTMLCanvasElement} canvas
   * @param {Uint32Array} faces three points each
   * @param {number} first first point of the surface
   * @param {number} count number of its points
   */
  constructor(canvas, faces, first, count) {
    this.faces = faces;
    this.first = first;
    this.count = count;
    this.finest = isSlow() ? 2 : 1; // twice as many pixels along each side once it stands still, in place of smooth edges
    const gl = this.gl = canvas.getContext("webgl", { antialias: this.finest === 1, alpha: true });
    if (!gl) return;
    const program = this.program = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, FRAGMENT]]) {
      const shader = gl.createShader(/** @type {number} */ (kind));
      gl.shaderSource(shader, /** @type {string} */ (text));
      gl.compileShader(shader);
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    gl.useProgram(program);
    this.uniforms = ["axes", "middle", "scale"].map((name) => gl.getUniformLocation(program, name));
    this.buffers = ["place", "normal"].map((name) => {
      const buffer = gl.createBuffer(), slot = gl.getAttribLocation(program, name);
      gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
      gl.enableVertexAttribArray(slot);
      gl.vertexAttribPointer(slot, 3, gl.FLOAT, false, 0, 0);
      return buffer;
    });
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, Uint16Array.from(faces), gl.STATIC_DRAW);
    gl.enable(gl.DEPTH_TEST);
  }

  /** Paint the surface of some points, which move or stand still. */
  paint(sight, points, still = false) {
    const gl = this.gl, dense = (window.devicePixelRatio || 1) * (still ? this.finest : 1);
    if (!gl) return;
    const [wide, high] = [sight.width, sight.height].map((side) => Math.round(dense * side));
    if (gl.canvas.width !== wide || gl.canvas.height !== high) Object.assign(gl.canvas, { width: wide, height: high });
    const places = new Float32Array(points.subarray(3 * this.first, 3 * (this.first + this.count)));
    [places, normalsOf(places, this.faces)].forEach((array, i) => {
      gl.bindBuffer(gl.ARRAY_BUFFER, this.buffers[i]);
      gl.bufferData(gl.ARRAY_BUFFER, array, gl.DYNAMIC_DRAW);
    });
    gl.viewport(0, 0, gl.canvas.width, gl.canvas.height);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    const [axes, middle, scale] = this.uniforms;
    gl.uniformMatrix3fv(axes, false, sight.axes.flat());
    gl.uniform3fv(middle, sight.middle.map((side) => side.middle));
    gl.uniform3f(scale, (2 * sight.scale) / sight.width, (2 * sight.scale) / sight.height, 0.4 / sight.size);
    gl.drawElements(gl.TRIANGLES, this.faces.length, gl.UNSIGNED_SHORT, 0);
  }
}

/** True if a program draws, as there is no graphics card. */
function isSlow() {
  const gl = document.createElement("canvas").getContext("webgl"), names = gl?.getExtension("WEBGL_debug_renderer_info");
  return Boolean(names) && /swiftshader|llvmpipe|software|basic render/i.test(gl.getParameter(names.UNMASKED_RENDERER_WEBGL));
}

/** Outward normals of the points of a surface, weighted by area. */
function normalsOf(places, faces) {
  const normals = new Float32Array(places.length);
  for (let i = 0; i < faces.length; i += 3) {
    const [a, b, c] = [3 * faces[i], 3 * faces[i + 1], 3 * faces[i + 2]];
    const x1 = places[b] - places[a], y1 = places[b + 1] - places[a + 1], z1 = places[b + 2] - places[a + 2];
    const x2 = places[c] - places[a], y2 = places[c + 1] - places[a + 1], z2 = places[c + 2] - places[a + 2];
    const x = y1 * z2 - z1 * y2, y = z1 * x2 - x1 * z2, z = x1 * y2 - y1 * x2;
    for (let k = 0; k < 3; k++) {
      const at = k === 0 ? a : k === 1 ? b : c;
      normals[at] += x;
      normals[at + 1] += y;
      normals[at + 2] += z;
    }
  }
  return normals;
}
