// Draws the mesh with WebGL 2.

class Renderer {
  constructor(canvas, world, mesh) {
    const gl = canvas.getContext('webgl2', {antialias: true, powerPreference: 'high-performance'});
    if (!gl) throw new Error('this browser offers no WebGL 2 (switch on graphics acceleration)');
    Object.assign(this, {canvas, gl, world, mesh});
    this.textures = world.pages.map(() => null);
    this.errors = [];
    this.settings = {
      view: kViews.light, errorRange: 0, illuminance: false, valueScale: 1, levels: [],
      isolines: true, low: 1, high: 1000, logarithmic: true, curve: null, stops: 0,
    };
    this.program = this.link();
    this.uniforms = new Map();
    this.fillBuffers();
    this.errorTextures();
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LEQUAL);
    this.grey = this.texture();
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA8, 1, 1, 0, gl.RGBA, gl.UNSIGNED_BYTE,
      new Uint8Array([128, 128, 128, 255]));
  }

  link() {
    const gl = this.gl, program = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, kVertexShader],
      [gl.FRAGMENT_SHADER, kFragmentShader]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS))
        throw new Error('a shader does not compile: ' + gl.getShaderInfoLog(shader));
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS))
      throw new Error('the shaders do not link: ' + gl.getProgramInfoLog(program));
    return program;
  }

  at(name) {
    if (!this.uniforms.has(name))
      this.uniforms.set(name, this.gl.getUniformLocation(this.program, name));
    return this.uniforms.get(name);
  }

  fillBuffers() {
    const {gl, mesh} = this;
    this.vertices = gl.createVertexArray();
    gl.bindVertexArray(this.vertices);
    const attribute = (name, data, size, type) => {
      const place = gl.getAttribLocation(this.program, name);
      if (place < 0) return;
      gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
      gl.bufferData(gl.ARRAY_BUFFER, data, gl.STATIC_DRAW);
      gl.enableVertexAttribArray(place);
      if (type === gl.UNSIGNED_INT) gl.vertexAttribIPointer(place, size, type, 0, 0);
      else gl.vertexAttribPointer(place, size, type, type === gl.UNSIGNED_BYTE, 0, 0);
    };
    attribute('position', mesh.positions, 3, gl.FLOAT);
    attribute('uv', mesh.uvs, 2, gl.FLOAT);
    attribute('chart', mesh.charts, 1, gl.UNSIGNED_INT);
    if (this.world.light && this.world.light.reflectance.length)
      attribute('reflectance', this.reflectances(), 3, gl.FLOAT);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, mesh.indices, gl.STATIC_DRAW);
  }

  reflectances() {
    const of = this.world.light.reflectance;
    const result = new Float32Array(3 * this.mesh.charts.length);
    this.mesh.charts.forEach((chart, i) => result.set(of[chart], 3 * i));
    return result;
  }

  texture() {
    const gl = this.gl, texture = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
    return texture;
  }

  smooth() {
    const gl = this.gl;
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR_MIPMAP_LINEAR);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.LINEAR);
    const finer = gl.getExtension('EXT_texture_filter_anisotropic');
    if (finer) gl.texParameterf(gl.TEXTURE_2D, finer.TEXTURE_MAX_ANISOTROPY_EXT, 4);
  }

  // The longest side of a page that device and memory take.
  longestSide() {
    const kBytes = matchMedia('(pointer: coarse)').matches ? 3e8 : 3e9, kTexel = 16 / 3;  // with mip levels
    return Math.min(this.gl.getParameter(this.gl.MAX_TEXTURE_SIZE),
      Math.sqrt(kBytes / kTexel / this.world.pages.length));
  }

  // Shows an image of display values on a page.
  setImage(page, image) {
    const gl = this.gl, texture = this.texture();
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA8, gl.RGBA, gl.UNSIGNED_BYTE, image);
    gl.generateMipmap(gl.TEXTURE_2D);
    this.smooth();
    this.textures[page] = {texture, scale: 1};
  }

  // Shows light on a page: levels of detail of shared exponents, see light.js.
  setLight(page, {width, height, levels, scale}) {
    const gl = this.gl, texture = this.texture();
    const first = timesHalved({width, height}, this.longestSide());
    levels.slice(first).forEach((texels, level) => gl.texImage2D(gl.TEXTURE_2D, level, gl.RGB9_E5,
      Math.max(1, width >> (first + level)), Math.max(1, height >> (first + level)), 0, gl.RGB,
      gl.UNSIGNED_INT_5_9_9_9_REV, texels));
    this.smooth();
    this.textures[page] = {texture, scale, holdsLight: true};
  }

  errorTextures() {
    const gl = this.gl, all = [];
    for (const {error} of this.world.pages) {
      if (!error) continue;
      const cells = Float32Array.from(error.tenThousandths, (e) => (e < 0 ? -1 : e / 1e4));
      cells.forEach((e) => e >= 0 && all.push(e));
      gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
      this.errors.push(this.texture());
      gl.texImage2D(gl.TEXTURE_2D, 0, gl.R32F, error.columns, cells.length / error.columns, 0,
        gl.RED, gl.FLOAT, cells);
    }
    all.sort((a, b) => a - b);
    this.settings.errorRange = all.length ? Math.max(1 / 255, all[Math.floor(0.99 * all.length)]) : 0;
  }

  // Draws what the camera {eye, yaw, pitch, fov, near, far} sees; with `fronts`, fronts only.
  draw(camera) {
    const gl = this.gl, s = this.settings;
    gl.viewport(0, 0, this.canvas.width, this.canvas.height);
    gl.clearColor(0.055, 0.06, 0.07, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.useProgram(this.program);
    gl.bindVertexArray(this.vertices);
    gl.uniform3fv(this.at('eye'), camera.eye);
    gl.uniformMatrix4fv(this.at('camera'), false, cameraMatrix(camera, this.aspect()));
    gl.uniform1i(this.at('view'), s.view);
    gl.uniform1i(this.at('page'), 0);
    gl.uniform1i(this.at('error'), 1);
    gl.uniform1f(this.at('errorRange'), s.errorRange);
    this.setTone(s);
    this.setFalseColours(s);
    for (const part of this.world.parts) this.drawPart(part, camera.fronts);
  }

  setTone({curve, stops}) {
    if (!curve) return;
    const gl = this.gl;
    gl.uniform1i(this.at('tone'), kTones[curve.name]);
    gl.uniform1f(this.at('toneScale'), curve.scale * 2 ** stops);
    gl.uniform1f(this.at('toneWhite'), curve.white);
    gl.uniform4fv(this.at('toneParameter'), curve.parameter);
    gl.uniform3fv(this.at('toneOffset'), curve.offset);
  }

  setFalseColours(s) {
    const gl = this.gl;
    gl.uniform1i(this.at('illuminance'), s.illuminance);
    gl.uniform1f(this.at('valueScale'), s.valueScale);
    const levels = s.levels.slice(0, kMostLevels);
    if (levels.length) gl.uniform1fv(this.at('levels'), levels);
    gl.uniform1i(this.at('levelCount'), levels.length);
    gl.uniform1i(this.at('isolines'), s.isolines);
    gl.uniform1f(this.at('low'), s.low);
    gl.uniform1f(this.at('high'), s.high);
    gl.uniform1i(this.at('logarithmic'), s.logarithmic);
  }

  drawPart(part, fronts) {
    const gl = this.gl, image = this.textures[part.page];
    gl.activeTexture(gl.TEXTURE1);
    gl.bindTexture(gl.TEXTURE_2D, this.errors[part.page] || this.grey);
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, image ? image.texture : this.grey);
    gl.uniform1i(this.at('lit'), image ? 1 : 0);
    gl.uniform1i(this.at('holdsLight'), image && image.holdsLight ? 1 : 0);
    gl.uniform1f(this.at('pageScale'), image ? image.scale : 1);
    gl.uniform1i(this.at('pageNumber'), part.page);
    if (part.oneSided || fronts) gl.enable(gl.CULL_FACE);
    else gl.disable(gl.CULL_FACE);
    gl.drawElements(gl.TRIANGLES, 3 * part.triangles, gl.UNSIGNED_INT, 4 * part.firstIndex);
  }

  aspect() {
    return this.canvas.width / this.canvas.height;
  }
}

// The field of view is that of the smaller side of the window, but not so that a tall window would
// distort what is above and below.
const kMostFovY = 1.45;
function fovY(fov, aspect) {
  return aspect >= 1 ? fov : Math.min(kMostFovY, 2 * Math.atan(Math.tan(fov / 2) / aspect));
}

function cameraMatrix({yaw, pitch, fov, near, far}, aspect) {
  return multiplied(perspective(fovY(fov, aspect), aspect, near, far), turnMatrix(yaw, pitch));
}
