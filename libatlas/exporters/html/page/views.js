// What the panel shows beside each view: legends, settings of the light, thumbnails of the pages.

function viewsOf(world, renderer) {
  const pictures = world.pages.some((page) => page.type);
  const views = [{name: 'light', text: pictures ? 'Light' : 'Shape'}];
  if (world.light) views.push({name: 'falseColours', text: 'False colours'});
  views.push({name: 'charts', text: 'Charts'}, {name: 'pages', text: 'Page use'});
  if (renderer.settings.errorRange > 0) views.push({name: 'error', text: 'Error'});
  return views;
}

// Colours of the legend, by the shader's formulas.
function turboCss(x) {
  const sum = (...c) => Math.round(255 * clamp(c.reduceRight((s, k) => s * x + k), 0, 1));
  return `rgb(${sum(0.13572138, 4.6153926, -42.66032258, 132.13108234, -152.94239396, 59.28637943)},` +
    `${sum(0.09140261, 2.19418839, 4.84296658, -14.18503333, 4.27729857, 2.82956604)},` +
    `${sum(0.1066733, 12.64194608, -60.58204836, 110.36276771, -89.90310912, 27.34824973)})`;
}
function heatCss(x) {
  const mix = (a, b, t) => a.map((v, k) => v + (b[k] - v) * clamp(t, 0, 1));
  const s = clamp((x - 0.25) / 0.5, 0, 1);
  const c = mix(mix([0.10, 0.12, 0.22], [0.55, 0.16, 0.42], 2 * x),
    mix([0.95, 0.42, 0.22], [1, 0.95, 0.7], 2 * x - 1), s * s * (3 - 2 * s));
  return `rgb(${c.map((v) => Math.round(255 * v)).join(',')})`;
}

class Views {
  constructor(viewer) {
    Object.assign(this, {viewer, panel: at('panel'), thumbnails: []});
  }

  show(name) {
    this.name = name;
    const makers = {
      light: () => this.exposure(), falseColours: () => this.falseColours(), charts: () => this.charts(),
      pages: () => this.pages(), error: () => this.error(),
    };
    const content = makers[name]();
    this.panel.hidden = !content;
    document.body.classList.toggle('with-panel', Boolean(content));
    if (!content) return;
    const folded = element('details', {open: this.panel.querySelector('details')?.open ?? true},
      element('summary', {textContent: content.title}), ...content.parts);
    folded.addEventListener('toggle', () => this.drawLegends());
    this.panel.replaceChildren(folded);
    this.drawLegends();
  }

  drawLegends() {
    if (this.name === 'falseColours') this.drawLegend();
    if (this.name === 'error') this.drawErrorLegend();
  }

  exposure() {
    const {viewer} = this, {settings} = viewer.renderer, {light} = viewer.world;
    if (!light) return null;
    const range = element('input', {type: 'range', min: -8, max: 8, step: 0.1, value: settings.stops,
      attributes: {'aria-label': 'Exposure in stops'}});
    const value = element('span', {textContent: this.stopsText()});
    range.addEventListener('input', () => {
      settings.stops = Number(range.value);
      value.textContent = this.stopsText();
      viewer.changed();
    });
    const tone = element('select');
    const names = {linear: 'Linear', reinhard: 'Reinhard', drago: 'Drago',
      'reinhard-devlin': 'Reinhard–Devlin'};
    fillSelect(tone, light.curves.map((curve, i) => [i, names[curve.name]]));
    tone.value = light.curves.indexOf(settings.curve);
    tone.addEventListener('change', () => {
      settings.curve = light.curves[Number(tone.value)];
      viewer.changed();
    });
    return {title: 'Exposure',
      parts: [element('div', {className: 'row'}, range, value), row('Tone curve', tone)]};
  }

  stopsText() {
    const {stops} = this.viewer.renderer.settings;
    return (stops > 0 ? '+' : stops < 0 ? '−' : '±') + Math.abs(stops).toFixed(1) + ' EV';
  }

  falseColours() {
    const {viewer} = this, {settings} = viewer.renderer;
    const quantity = element('select');
    fillSelect(quantity, viewer.quantities.map((q, i) => [i, q.text + (q.unit && `, ${q.unit}`)]));
    quantity.value = viewer.quantities.indexOf(viewer.quantity);
    quantity.addEventListener('change', () => {
      viewer.setQuantity(viewer.quantities[Number(quantity.value)]);
      this.show(this.name);
    });
    const number = (key, label) => {
      const input = element('input', {type: 'number', step: 'any', min: 0,
        attributes: {'aria-label': label}, value: Number(settings[key].toPrecision(3))});
      input.addEventListener('change', () => {
        this.setRange({[key]: Number(input.value)});
        input.value = Number(settings[key].toPrecision(3));
      });
      return input;
    };
    const check = (key, text) => {
      const input = element('input', {type: 'checkbox', checked: settings[key]});
      input.addEventListener('change', () => this.setRange({[key]: input.checked}));
      return row(text, input);
    };
    const parts = [row('Quantity', quantity),
      element('canvas', {className: 'legend'}), element('div', {className: 'row'},
        element('span', {textContent: 'From'}), number('low', 'Low end of the scale'),
        element('span', {textContent: 'to'}), number('high', 'High end of the scale')),
      check('logarithmic', 'Logarithmic scale'), check('isolines', 'Isolines')];
    if (viewer.quantity.illuminance && viewer.hasUnknownReflectance())
      parts.push(element('p', {textContent: 'Striped: a texture hides the reflectance there.'}));
    return {title: 'False colours', parts: [...parts, ...viewer.measuring.controls()]};
  }

  // Takes changes of the false colours' settings that leave a range.
  setRange(changes) {
    const {settings} = this.viewer.renderer;
    const next = {...settings, ...changes};
    const least = next.logarithmic ? next.high / 1e6 : 0;
    next.low = Math.max(least, next.low);
    if (!(next.high > next.low)) return;
    Object.assign(settings, next);
    settings.levels = levelsWithin(next.low, next.high, next.logarithmic);
    this.drawLegend();
    this.viewer.changed();
  }

  // Prepares a canvas of the panel for its size on the screen. Returns its context and size.
  legendCanvas() {
    const canvas = this.panel.querySelector('.legend');
    if (!canvas || !canvas.clientWidth) return null;  // folded
    const ratio = devicePixelRatio || 1, width = canvas.clientWidth, height = canvas.clientHeight;
    Object.assign(canvas, {width: width * ratio, height: height * ratio});
    const context = canvas.getContext('2d');
    context.scale(ratio, ratio);
    context.font = '13px system-ui, sans-serif';
    context.textBaseline = 'middle';
    return {context, width, height};
  }

  drawLegend() {
    const made = this.legendCanvas();
    if (!made) return;
    const {context, width, height} = made, {settings} = this.viewer.renderer;
    const flat = width > 2 * height;  // on phones
    const margin = flat ? 22 : 8, long = (flat ? width : height) - 2 * margin, bar = flat ? 22 : 34;
    // A bar across the legend, `x` of its length from the low end.
    const across = (x, thick) => (flat ? context.fillRect(margin + long * x, 0, thick, bar)
      : context.fillRect(0, margin + long * (1 - x) - thick, bar, thick));
    for (let i = 0; i < long; ++i) {
      context.fillStyle = turboCss(0.02 + 0.96 * i / long);
      across(i / long, 1.5);
    }
    const {low, high, logarithmic, levels, isolines} = settings, {unit} = this.viewer.quantity;
    context.textAlign = flat ? 'center' : 'left';
    let last = -Infinity;
    for (const level of levels) {
      const x = logarithmic ? Math.log(level / low) / Math.log(high / low) : (level - low) / (high - low);
      context.fillStyle = isolines ? 'rgba(0,0,0,.75)' : 'rgba(255,255,255,.5)';
      across(x, 1.5);
      if (long * x - last < (flat ? 44 : 14)) continue;
      last = long * x;
      context.fillStyle = '#f1f2f4';
      if (flat) context.fillText(shortNumber(level), margin + last, bar + 12);
      else context.fillText(`${shortNumber(level)} ${unit}`, bar + 10, margin + long - last);
    }
  }

  charts() {
    const count = new Set(this.viewer.mesh.charts).size;
    return {title: 'Charts', parts: [element('p', {textContent:
      `${count.toLocaleString('en')} charts, each in a colour of its own: the parts that the surface was ` +
      'cut into and laid flat.'})]};
  }

  error() {
    const {errorRange} = this.viewer.renderer.settings;
    return {title: 'Error of the pages', parts: [element('canvas', {className: 'legend flat'}),
      element('p', {textContent: 'How far what the pages show is from the scene’s light, as root mean ' +
        `square over cells of 32 texels, of 255 display values. The bar ends at ${(255 * errorRange).toFixed(1)}, ` +
        'below which 99 % of the cells are. Grey: not measured.'})]};
  }

  drawErrorLegend() {
    const made = this.legendCanvas();
    if (!made) return;
    const {context, width} = made, {errorRange} = this.viewer.renderer.settings;
    for (let x = 0; x < width; ++x) {
      context.fillStyle = heatCss(x / width);
      context.fillRect(x, 0, 1.5, 18);
    }
    context.fillStyle = '#f1f2f4';
    for (const [share, align] of [[0, 'left'], [0.5, 'center'], [1, 'right']]) {
      context.textAlign = align;
      context.fillText((255 * errorRange * share).toFixed(1), share * width, 32);
    }
  }

  pages() {
    const {world, mesh} = this.viewer;
    const list = element('div', {className: 'pages'});
    world.pages.forEach((page, i) => {
      const canvas = this.thumbnail(i, 256);
      const share = 100 * this.usedShare(i);
      const button = element('button', {type: 'button'}, canvas, `${i}: ${share.toFixed(0)} % used`);
      button.setAttribute('aria-label', `Page ${i}, ${share.toFixed(0)} percent used. Enlarge`);
      button.addEventListener('click', () => this.enlarge(i));
      list.append(button);
    });
    const charts = new Set(mesh.charts).size;
    return {title: 'Pages', parts: [element('p', {textContent: `${charts.toLocaleString('en')} charts on ${world.pages.length} ` +
        `${world.pages.length === 1 ? 'page' : 'pages'}; on the surface, each page has its colour.`}), list]};
  }

  // Returns the share of a page that triangles cover.
  usedShare(page) {
    const {mesh, world} = this.viewer;
    let area = 0;
    for (const part of world.parts) {
      if (part.page !== page) continue;
      for (let k = part.firstIndex; k < part.firstIndex + 3 * part.triangles; k += 3) {
        const [a, b, c] = [0, 1, 2].map((i) => 2 * mesh.indices[k + i]);
        const u = mesh.uvs;
        area += Math.abs((u[b] - u[a]) * (u[c + 1] - u[a + 1]) - (u[c] - u[a]) * (u[b + 1] - u[a + 1])) / 2;
      }
    }
    return area;
  }

  // Returns a canvas with the page and the outlines of its charts.
  thumbnail(page, side) {
    const picture = this.viewer.pictures[page];
    const aspect = picture ? picture.width / picture.height : 1;
    const canvas = element('canvas', {width: aspect >= 1 ? side : side * aspect,
      height: aspect >= 1 ? side / aspect : side});
    const context = canvas.getContext('2d');
    if (picture) context.drawImage(picture, 0, 0, canvas.width, canvas.height);
    context.strokeStyle = 'rgba(255,199,90,.9)';
    context.lineWidth = side > 500 ? 1.2 : 0.7;
    context.beginPath();
    const {uvs} = this.viewer.mesh;
    const edges = this.outlines(page);
    for (let k = 0; k < edges.length; k += 2) {
      const [a, b] = [2 * edges[k], 2 * edges[k + 1]];
      context.moveTo(uvs[a] * canvas.width, (1 - uvs[a + 1]) * canvas.height);
      context.lineTo(uvs[b] * canvas.width, (1 - uvs[b + 1]) * canvas.height);
    }
    context.stroke();
    return canvas;
  }

  // Returns the edges that only one triangle of a page has, as pairs of vertices.
  outlines(page) {
    const {mesh, world} = this.viewer, seen = new Map();
    for (const part of world.parts) {
      if (part.page !== page) continue;
      for (let k = part.firstIndex; k < part.firstIndex + 3 * part.triangles; ++k) {
        const a = mesh.indices[k], b = mesh.indices[k % 3 === 2 ? k - 2 : k + 1];
        const key = Math.min(a, b) * 67108864 + Math.max(a, b);
        seen.set(key, (seen.get(key) || 0) + 1);
      }
    }
    const edges = [];
    for (const [key, times] of seen)
      if (times === 1) edges.push(Math.floor(key / 67108864), key % 67108864);
    return edges;
  }

  enlarge(page) {
    const dialog = at('enlarged');
    dialog.querySelector('canvas').replaceWith(this.thumbnail(page, 1024));
    dialog.querySelector('p').textContent = `Page ${page}; charts are outlined.`;
    dialog.showModal();
  }
}
