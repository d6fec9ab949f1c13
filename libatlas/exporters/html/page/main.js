// Puts the page together, and offers scripts what it shows as window.libatlas.

class Viewer {
  constructor(world, mesh) {
    Object.assign(this, {world, mesh, tree: null, view: 'light', pointer: null, frames: 0});
    mesh.parts = world.parts;
    mesh.anyOneSided = world.parts.some((part) => part.oneSided);
    this.canvas = at('view');
    this.renderer = new Renderer(this.canvas, world, mesh);
    this.motion = new Motion(world, mesh);
    this.light = world.light;
    this.lightPages = world.pages.map(() => null);
    this.pictures = world.pages.map(() => null);
    this.quantities = quantitiesOf(world);
    this.views = viewsOf(world, this.renderer);
    this.places = [{text: 'Start', go: () => this.motion.reset()},
      ...world.viewpoints.map((place, i) => (
        {text: place.name || `Viewpoint ${i + 2}`, go: () => this.goToView(place)})),
      {text: 'From outside', go: () => this.motion.goOutside([-0.75, -0.5, -0.55])},
      {text: 'From above', go: () => this.motion.goOutside([0, -1, -0.01])}];
    this.measuring = new Measuring(this);
    this.panelViews = new Views(this);
    if (this.light) {
      this.renderer.settings.curve = this.light.curves[0];
      this.setQuantity(this.quantities[0]);
    }
    this.controls = new Controls(this);
    this.controls.showMode(this.motion.mode);
    this.input = new Input(this.canvas, this.motion, this.actions());
    window.addEventListener('resize', () => this.changed());
    this.show('light');
    this.controls.hint();
  }

  actions() {
    const viewer = this;
    return {
      changed: () => this.changed(),
      hover: (place) => this.hover(place),
      stick: (from, to) => this.controls.stick(from, to),
      allowsLock: () => this.view !== 'falseColours',
      get drag() { return viewer.measuring.active ? viewer.measuring : null; },
    };
  }

  // Asks for a picture. Pictures are drawn while something moves, and not else.
  changed() {
    if (this.asked) return;
    this.asked = true;
    requestAnimationFrame((now) => this.frame(now));
  }

  frame(now) {
    this.asked = false;
    const seconds = clamp((now - (this.last ?? now)) / 1000, 0, 0.1);
    const moves = this.motion.advance(seconds);
    this.last = moves ? now : undefined;
    this.draw();
    if (moves) this.changed();
  }

  draw() {
    const ratio = Math.min(2, devicePixelRatio || 1);
    const width = Math.round(this.canvas.clientWidth * ratio);
    const height = Math.round(this.canvas.clientHeight * ratio);
    if (this.canvas.width !== width || this.canvas.height !== height)
      Object.assign(this.canvas, {width, height});
    this.renderer.draw(this.motion.camera());
    ++this.frames;
    this.drawMarks(ratio);
  }

  drawMarks(ratio) {
    const marks = at('marks');
    marks.hidden = this.view !== 'falseColours';
    if (marks.hidden) return;
    if (marks.width !== this.canvas.width || marks.height !== this.canvas.height)
      Object.assign(marks, {width: this.canvas.width, height: this.canvas.height});
    const context = marks.getContext('2d');
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.clearRect(0, 0, marks.width, marks.height);
    context.scale(ratio, ratio);
    this.measuring.draw(context, (p) => this.project(p));
  }

  // Returns where a point is in the picture, in CSS pixels, or null behind the eye.
  project(p) {
    const camera = this.motion.camera();
    const m = cameraMatrix(camera, this.renderer.aspect()), d = sub(p, camera.eye);
    const row = (k) => m[k] * d[0] + m[4 + k] * d[1] + m[8 + k] * d[2] + m[12 + k];
    const w = row(3);
    if (w <= 0) return null;
    return [(row(0) / w / 2 + 0.5) * this.canvas.clientWidth, (0.5 - row(1) / w / 2) * this.canvas.clientHeight];
  }

  rayAt(x, y) {
    const {eye, yaw, pitch, fov, fronts} = this.motion.camera();
    const width = this.canvas.clientWidth, height = this.canvas.clientHeight, aspect = width / height;
    const up = Math.tan(fovY(fov, aspect) / 2);
    const m = turnMatrix(yaw, pitch);
    const d = [(2 * x / width - 1) * up * aspect, (1 - 2 * y / height) * up, -1];
    const along = [0, 1, 2].map((k) => m[4 * k] * d[0] + m[4 * k + 1] * d[1] + m[4 * k + 2] * d[2]);
    return {from: eye, along: normalized(along), fronts};
  }

  middleOfPicture() {
    return [this.canvas.clientWidth / 2, this.canvas.clientHeight / 2];
  }

  // Returns what lies at a place of the picture, in CSS pixels, or null.
  pick(x, y) {
    if (!this.tree) return null;
    const {from, along, fronts} = this.rayAt(x, y);
    const hit = this.tree.ray(from, along, {fronts});
    if (!hit) return null;
    const normal = this.tree.normal(hit.triangle);
    return {...this.reading(hit), position: add(from, scaled(along, hit.distance)),
      normal: dot(normal, along) > 0 ? scaled(normal, -1) : normal};
  }

  // Returns page, uv, chart and, on pages of light, the light and the chosen quantity's value there.
  reading({triangle, weights, distance}) {
    const corners = [0, 1, 2].map((k) => this.mesh.indices[3 * triangle + k]);
    const uv = [0, 1].map((axis) => corners.reduce(
      (sum, vertex, k) => sum + weights[k] * this.mesh.uvs[2 * vertex + axis], 0));
    const page = this.tree.partOf(triangle).page, chart = this.mesh.charts[corners[0]];
    const result = {page, u: uv[0], v: uv[1], chart, distance};
    const light = this.valueAt(page, ...uv);
    if (!light) return result;
    return {...result, light, value: valueOf(this.quantity, light, this.light.reflectance[chart])};
  }

  // Returns the light (RGB) of a page of light, or null.
  valueAt(page, u, v) {
    return this.lightPages[page] && lightAt(this.lightPages[page], u, v);
  }

  hover(place) {
    this.pointer = place;
    this.updateReading();
  }

  updateReading() {
    const output = at('reading');
    const hit = this.view === 'falseColours' && this.pointer && this.pick(...this.pointer);
    output.hidden = !hit || !hit.light;
    if (output.hidden) return;
    const bold = element('b', {textContent: hit.value === null ? 'hidden by a texture'
      : `${shortNumber(hit.value)} ${this.quantity.unit}`});
    const others = this.quantities.filter((q) => q !== this.quantity).map((q) =>
      [q, valueOf(q, hit.light, this.light.reflectance[hit.chart])]).filter(([, v]) => v !== null);
    output.replaceChildren(bold, ...others.map(([q, v]) => `  ·  ${shortNumber(v)} ${q.unit}`),
      `  ·  ${hit.distance.toFixed(2)} m away`);
  }

  hasUnknownReflectance() {
    return this.light.reflectance.some((r) => Math.min(...r) <= 0);
  }

  // Chooses the quantity, and a range that shows most of what the pages hold.
  setQuantity(quantity) {
    this.quantity = quantity;
    const {settings} = this.renderer;
    settings.illuminance = Boolean(quantity.illuminance);
    settings.valueScale = quantity.scale;
    const white = this.light.curves.find((c) => c.name === 'linear');
    const most = (white ? 1 / white.scale : 1) * quantity.scale * (quantity.illuminance ? 2 : 1);
    settings.high = roundUp(most);
    settings.low = settings.logarithmic ? settings.high / 200 : 0;
    settings.levels = levelsWithin(settings.low, settings.high, settings.logarithmic);
    this.changed();
  }

  show(name) {
    this.view = name;
    this.renderer.settings.view = kViews[name];
    at('views').value = name;
    if (name === 'falseColours') document.exitPointerLock?.();
    this.refresh();
  }

  // Makes the panel anew.
  refresh() {
    this.panelViews.show(this.view);
    this.updateReading();
    this.changed();
  }

  setMode(mode) {
    this.motion.setMode(mode);
    this.controls.showMode(mode);
    this.controls.hint();
    this.changed();
  }

  goTo(index) {
    this.places[index].go();
    this.controls.showMode(this.motion.mode);
    this.changed();
  }

  // A view of the scene's file: in rooms the eyes stay where it puts them.
  goToView(place) {
    this.motion.setMode(this.world.inside ? 'fly' : 'orbit');
    this.motion.setView(place.position, place.direction);
  }

  expose(stops) {
    const {settings} = this.renderer;
    settings.stops = clamp(settings.stops + stops, -8, 8);
    this.refresh();
  }

  // Saves the picture with what is drawn on it.
  screenshot() {
    this.draw();
    const copy = element('canvas', {width: this.canvas.width, height: this.canvas.height});
    const context = copy.getContext('2d');
    context.drawImage(this.canvas, 0, 0);
    if (!at('marks').hidden) context.drawImage(at('marks'), 0, 0);
    copy.toBlob((blob) => {
      const link = element('a', {href: URL.createObjectURL(blob),
        download: `${this.world.title || 'world'}.png`});
      link.click();
      setTimeout(() => URL.revokeObjectURL(link.href), 10000);
    });
  }
}

// Returns the next of 1, 2, 5 times a power of ten.
function roundUp(value) {
  const ten = 10 ** Math.floor(Math.log10(value));
  return ten * ([1, 2, 5, 10].find((m) => m * ten >= 0.999 * value));
}

// Runs a long task beside the page: in a Worker made of the page's own text, since pages from a disk
// may start no other. Without one, the page waits.
function inWorker(tools, call, ...inputs) {
  return new Promise((resolve, reject) => {
    const text = `const tools = (${tools})(); onmessage = ({data}) => ` +
      `postMessage(tools.${call}(...data));`;
    const url = URL.createObjectURL(new Blob([text], {type: 'text/javascript'}));
    let worker;
    const finish = (done, value) => {
      worker?.terminate();
      URL.revokeObjectURL(url);
      done(value);
    };
    try {
      worker = new Worker(url);
    } catch {
      finish(resolve, tools()[call](...inputs));
      return;
    }
    worker.onmessage = ({data}) => finish(resolve, data);
    worker.onerror = (event) => finish(reject, new Error(event.message));
    worker.postMessage(inputs);
  });
}

async function loadPage(viewer, i) {
  const {type} = viewer.world.pages[i];
  const bytes = bytesOf(`page${i}`);
  at(`page${i}`).remove();  // the text is no longer needed
  if (type === 'application/x-atlas-light') {
    const page = await inWorker(lightTools, 'unpack', await inflated(bytes));
    viewer.renderer.setLight(i, page);
    viewer.pictures[i] = pictureOfLight(page, viewer.light.curves);
    delete page.levels;
    viewer.lightPages[i] = page;
  } else {
    const image = await readImage(bytes, type, viewer.renderer.longestSide());
    viewer.renderer.setImage(i, image);
    viewer.pictures[i] = pictureOf(image, true);
    image.close();
  }
  viewer.changed();
}

// Returns a canvas of at most 1024 pixels a side with an image, whose first row is the bottom one.
function pictureOf(image, upsideDown) {
  const scale = Math.min(1, 1024 / Math.max(image.width, image.height));
  const canvas = element('canvas', {width: Math.max(1, image.width * scale),
    height: Math.max(1, image.height * scale)});
  const context = canvas.getContext('2d');
  if (upsideDown) {
    context.translate(0, canvas.height);
    context.scale(1, -1);
  }
  context.drawImage(image, 0, 0, canvas.width, canvas.height);
  return canvas;
}

function pictureOfLight(page, curves) {
  const white = (curves.find((c) => c.name === 'linear') || curves[0]).scale;
  const step = Math.max(1, Math.ceil(Math.max(page.width, page.height) / 1024));
  const width = Math.max(1, Math.floor(page.width / step)), height = Math.max(1, Math.floor(page.height / step));
  const data = new ImageData(width, height);
  for (let y = 0; y < height; ++y)
    for (let x = 0; x < width; ++x) {
      const light = lightOfTexel(page, x * step, y * step);
      const to = 4 * ((height - 1 - y) * width + x);
      for (let k = 0; k < 3; ++k) data.data[to + k] = 255 * Math.min(1, light[k] * white) ** (1 / 2.2);
      data.data[to + 3] = 255;
    }
  const canvas = element('canvas', {width, height});
  canvas.getContext('2d').putImageData(data, 0, 0);
  return canvas;
}

async function loadAll(viewer) {
  const list = viewer.world.pages.map((page, i) => (page.type ? i : -1)).filter((i) => i >= 0);
  const kAtOnce = 3;
  let done = 0, next = 0;
  const progress = () => {
    at('progress').textContent = done < list.length ? `Loading light: page ${done + 1} of ${list.length}` : '';
  };
  const work = async () => {
    while (next < list.length) {
      progress();
      await loadPage(viewer, list[next++]);
      ++done;
    }
  };
  await Promise.all(Array.from({length: kAtOnce}, work));
  progress();
  if (viewer.view === 'pages') viewer.refresh();
}

async function growTree(viewer) {
  const {mesh} = viewer;
  const tree = await inWorker(triangleTools, 'build', mesh.positions, mesh.indices);
  viewer.tree = viewer.motion.tree = new TriangleTree(mesh, tree);
  viewer.changed();
}

function complain(error) {
  at('progress').textContent = '';
  at('trouble').textContent = `This world cannot be shown: ${error.message || error}`;
  at('trouble').hidden = false;
  console.error(error);
}

async function start() {
  if (typeof DecompressionStream === 'undefined')
    throw new Error('the browser is too old (Chrome 80, Firefox 113, Safari 16.4 or newer)');
  at('progress').textContent = 'Loading the world';
  const world = JSON.parse(at('world').textContent);
  const mesh = readMesh(world, await inflated(bytesOf('mesh')));
  const viewer = new Viewer(world, mesh);
  viewer.draw();
  hooks.viewer = viewer;
  await Promise.all([loadAll(viewer), growTree(viewer)]);
  viewer.draw();
  return viewer;
}

// For scripts and tests. `ready` ends when all pages are shown. Places are in CSS pixels.
const hooks = window.libatlas = {
  pick: (x, y) => hooks.viewer.pick(x, y),
  valueAt: (page, u, v) => hooks.viewer.valueAt(page, u, v),
};
hooks.ready = start();
hooks.ready.catch(complain);
