// Draws charts with WebGL 2: on the mesh, or on the page. A chart has the same colour in both.
import { product } from "./glb.js";

const vertexShader = `#version 300 es
uniform mat4 placed;
uniform vec4 flat_;  // of the page: scale and offset; scale 0: in space
in vec3 position;
in vec3 uvChart;
out vec3 at;
out vec3 uv;
void main() {
  at = position;
  uv = uvChart;
  gl_Position = flat_.x == 0.0 ? placed * vec4(position, 1) : vec4(uvChart.xy * flat_.xy + flat_.zw, 0, 1);
}`;
const fragmentShader = `#version 300 es
precision highp float;
uniform vec2 page;
uniform float kind;  // 0: in space, 1: flat, 2: a seam
uniform float checker;
in vec3 at;
in vec3 uv;
out vec4 colour;
vec3 ofChart(float chart) {
  vec3 hue = abs(fract(chart * 0.61803 + vec3(0, 2, 1) / 3.0) * 6.0 - 3.0) - 1.0;
  float light = 0.62 + 0.14 * fract(chart * 0.381966);
  return light * mix(vec3(1), clamp(hue, 0.0, 1.0), 0.42);
}
void main() {
  if (kind == 2.0) { colour = vec4(0.05, 0.05, 0.07, 1); return; }
  vec3 own = ofChart(floor(uv.z + 0.5));
  vec2 cell = floor(uv.xy * page / checker);
  own *= checker > 0.0 && mod(cell.x + cell.y, 2.0) < 0.5 ? 0.84 : 1.0;
  if (kind == 0.0) {
    vec3 normal = normalize(cross(dFdx(at), dFdy(at)));
    own *= 0.45 + 0.75 * abs(dot(normal, normalize(vec3(0.35, 0.55, 0.76))));
  }
  colour = vec4(own, 1);
}`;

function programOf(gl) {
  const program = gl.createProgram();
  for (const [type, text] of [[gl.VERTEX_SHADER, vertexShader], [gl.FRAGMENT_SHADER, fragmentShader]]) {
    const shader = gl.createShader(type);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
  }
  gl.bindAttribLocation(program, 0, "position");
  gl.bindAttribLocation(program, 1, "uvChart");
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program) || "no WebGL 2");
  return program;
}

export class Viewer {
  constructor(canvas, isFlat) {
    this.canvas = canvas;
    this.isFlat = isFlat;
    const gl = (this.gl = canvas.getContext("webgl2", { antialias: true, preserveDrawingBuffer: true }));
    if (!gl) throw new Error("this browser has no WebGL 2");
    this.program = programOf(gl);
    this.place = Object.fromEntries(["placed", "flat_", "page", "kind", "checker"].map((name) => [name, gl.getUniformLocation(this.program, name)]));
    this.fills = this.#array();
    this.lines = this.#array();
    this.angles = [0.5, 0.35];
    this.zoom = 1;
    this.page = [1, 1];
    this.checker = 0;
    this.frames = 0;
    this.#listen();
    new ResizeObserver(() => this.draw()).observe(canvas);
  }

  #array() {
    const { gl } = this, array = gl.createVertexArray(), buffer = gl.createBuffer();
    gl.bindVertexArray(array);
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    for (const k of [0, 1]) {
      gl.enableVertexAttribArray(k);
      gl.vertexAttribPointer(k, 3, gl.FLOAT, false, 24, 12 * k);
    }
    return { array, buffer, count: 0 };
  }

  #put(target, numbers) {
    const { gl } = this;
    gl.bindBuffer(gl.ARRAY_BUFFER, target.buffer);
    gl.bufferData(gl.ARRAY_BUFFER, numbers, gl.STATIC_DRAW);
    target.count = numbers.length / 6;
  }

  // fills, lines: 6 numbers a corner: position, uv, chart. page: width and height in texels.
  show({ fills, lines, page, centre, radius, checker }) {
    this.#put(this.fills, fills);
    this.#put(this.lines, lines);
    Object.assign(this, { page, centre, radius, checker });
    this.draw();
  }

  draw() {
    if (this.asked) return;
    this.asked = true;
    requestAnimationFrame(() => {
      this.asked = false;
      this.#paint();
      ++this.frames;
    });
  }

  #paint() {
    const { gl, canvas, place } = this;
    const ratio = Math.min(devicePixelRatio, 2);
    canvas.width = Math.max(1, Math.round(canvas.clientWidth * ratio));
    canvas.height = Math.max(1, Math.round(canvas.clientHeight * ratio));
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clearColor(...(this.isFlat ? [0.13, 0.14, 0.16, 1] : [0.09, 0.1, 0.11, 1]));
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    if (!this.fills.count) return;
    gl.useProgram(this.program);
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LEQUAL);
    gl.enable(gl.POLYGON_OFFSET_FILL);
    gl.polygonOffset(1, 2);
    const aspect = canvas.width / canvas.height;
    gl.uniformMatrix4fv(place.placed, false, this.isFlat ? new Float32Array(16) : this.#placed(aspect));
    gl.uniform4f(place.flat_, ...(this.isFlat ? this.#flat(aspect) : [0, 0, 0, 0]));
    gl.uniform2f(place.page, ...this.page);
    gl.uniform1f(place.checker, this.checker);
    for (const [part, kind, mode] of [[this.fills, this.isFlat ? 1 : 0, gl.TRIANGLES], [this.lines, 2, gl.LINES]]) {
      gl.uniform1f(place.kind, kind);
      gl.bindVertexArray(part.array);
      gl.drawArrays(mode, 0, part.count);
    }
  }

  // The whole page, as large as fits.
  #flat(aspect) {
    const [width, height] = this.page, fit = Math.min(aspect / width, 1 / height) * 1.92 * this.zoom;
    return [(width * fit) / aspect, height * fit, (-width * fit) / aspect / 2, (-height * fit) / 2];
  }

  #placed(aspect) {
    const [turn, tilt] = this.angles, far = 2.6 / this.zoom / Math.min(1, aspect);
    const [c, s, d, t] = [Math.cos(turn), Math.sin(turn), Math.cos(tilt), Math.sin(tilt)];
    const scale = 1 / this.radius, [x, y, z] = this.centre.map((v) => -v * scale);
    const model = [scale, 0, 0, 0, 0, scale, 0, 0, 0, 0, scale, 0, x, y, z, 1];
    const turned = product([1, 0, 0, 0, 0, d, t, 0, 0, -t, d, 0, 0, 0, -far, 1], [c, 0, -s, 0, 0, 1, 0, 0, s, 0, c, 0, 0, 0, 0, 1]);
    const near = Math.max(0.01, far - 1.05), end = far + 1.05, wide = 2.4;
    const lens = [wide / aspect, 0, 0, 0, 0, wide, 0, 0, 0, 0, (end + near) / (near - end), -1, 0, 0, (2 * end * near) / (near - end), 0];
    return new Float32Array(product(lens, product(turned, model)));
  }

  #listen() {
    const { canvas } = this, held = new Map();
    const apart = () => {
      const [a, b] = [...held.values()];
      return b ? Math.hypot(a.x - b.x, a.y - b.y) : 0;
    };
    const zoomBy = (factor) => {
      this.zoom = Math.min(20, Math.max(0.3, this.zoom * factor));
      this.draw();
    };
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      held.set(event.pointerId, { x: event.clientX, y: event.clientY });
    });
    canvas.addEventListener("pointermove", (event) => {
      const last = held.get(event.pointerId);
      if (!last) return;
      const before = apart();
      held.set(event.pointerId, { x: event.clientX, y: event.clientY });
      if (held.size === 2) return before && zoomBy(apart() / before);
      if (this.isFlat) return;
      this.angles[0] += (event.clientX - last.x) * 0.008;
      this.angles[1] = Math.max(-1.5, Math.min(1.5, this.angles[1] + (event.clientY - last.y) * 0.008));
      this.draw();
    });
    for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, (event) => held.delete(event.pointerId));
    canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      zoomBy(Math.exp(-event.deltaY * 0.0012));
    }, { passive: false });
  }
}
