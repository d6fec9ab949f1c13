'use strict';
// Draws the report of an export. All figures come from the JSON report, which is part of the page:
// an element with the attribute data-key shows the figure at that key of it.
const report = JSON.parse(document.getElementById('report').textContent);
const asked = JSON.parse(document.getElementById('asked-data').textContent);
const pictures = JSON.parse(document.getElementById('pictures').textContent);

const section = (id) => document.getElementById(id);
const at = (key) => key.split('.').reduce((value, name) => value?.[name], report);

function element(name, properties = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(properties)) {
    if (key === 'class') made.className = value;
    else made.setAttribute(key, value);
  }
  made.append(...children);
  return made;
}

function shape(name, attributes, text) {
  const made = document.createElementNS('http://www.w3.org/2000/svg', name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  if (text !== undefined) made.textContent = text;
  return made;
}

function short(value) {
  if (value === null || value === undefined) return '–';
  if (typeof value !== 'number') return String(value);
  if (Number.isInteger(value)) return value.toLocaleString('en');
  return String(Number(value.toPrecision(4)));
}

// The figure at `key`, as it is shown; `scale` turns its unit into that of the text.
function figure(key, scale = 1) {
  const value = at(key);
  const text = typeof value === 'number' ? short(value * scale) : short(value);
  const made = element('span', {'data-key': key}, text);
  if (typeof value === 'number') made.dataset.value = String(value);
  return made;
}

function tile(key, label, scale = 1) {
  if (at(key) === undefined) return;
  const b = element('b');
  b.append(figure(key, scale));
  section('figures').append(element('div', {class: 'tile'}, b, element('span', {}, label)));
}

function table(heads, rows) {
  const cell = (name, content) => {
    const number = content instanceof Node ? content.dataset.value !== undefined
                                           : typeof content === 'number';
    const made = element(name, number ? {class: 'n'} : {});
    made.append(content instanceof Node ? content : short(content));
    return made;
  };
  const body = element('tbody');
  for (const row of rows) body.append(element('tr', {}, ...row.map((c) => cell('td', c))));
  const head = element('tr', {}, ...heads.map((text) => element('th', {}, text)));
  return element('div', {class: 'scroll'}, element('table', {}, element('thead', {}, head), body));
}

function remove(id) { section(id).remove(); }

function showHead() {
  section('target').textContent = report.target || report.scene.file;
  document.title = `${section('target').textContent}: report`;
  const s = report.scene;
  section('summary').textContent = `from ${s.file}: ${short(s.triangles)} triangles, ` +
      `${short(s.objects)} objects, ${short(s.materials)} materials, ` +
      `${s.lit ? 'lit' : 'without light'}; libatlas ${asked.version}`;
  tile('scene.triangles', 'triangles in');
  tile('simplify.triangles_out', 'triangles written');
  tile('charts.count', 'charts');
  tile('error.psnr', 'dB against the input');
  tile('packing.uv_utilization', '% of the pages used', 100);
  tile('textures.packed_texel', 'mm a texel', 1e3 * s.metres_per_unit);
  tile('packing.gpu_bytes', 'MiB of graphics memory', 1 / 1048576);
  tile('light.white', 'light shown white');
  tile('wall_s', 's in all');
  tile('peak_mib', 'MiB at most');
}

function showAdvice() {
  for (const line of report.advice ?? []) section('advice').append(element('p', {}, line));
  for (const d of s_defects())
    section('advice').append(element('p', {}, `${short(d.count)} x ${d.meaning}`));
}
const s_defects = () => report.scene.defects ?? [];

function showAsked() {
  section('asked').append(element('pre', {}, asked.command));
  const list = element('details', {}, element('summary', {}, 'Every option with its value'));
  list.append(element('pre', {}, asked.options));
  section('asked').append(list);
}

function showPlan() {
  const rows = report.plan.steps.map((step) => [step.stage, step.run ? 'runs' : 'skipped', step.reason]);
  section('plan').append(table(['stage', '', 'why'], rows));
}

function showStages() {
  const stages = report.stages, width = 620, row = 22, left = 92;
  const longest = Math.max(1e-9, ...stages.map((s) => Math.max(s.wall_ms, s.cpu_ms)));
  const svg = shape('svg', {width, height: row * stages.length + 4, role: 'img',
                            'aria-label': 'time of each stage'});
  stages.forEach((s, i) => {
    const span = (ms) => Math.max(1, ms / longest * (width - left - 130));
    svg.append(shape('text', {x: left - 8, y: i * row + 14, 'text-anchor': 'end'}, s.stage));
    svg.append(shape('rect', {class: 'bar', x: left, y: i * row + 3, width: span(s.wall_ms), height: 8}));
    svg.append(shape('rect', {class: 'bar2', x: left, y: i * row + 12, width: span(s.cpu_ms), height: 5}));
    svg.append(shape('text', {x: left + 6 + Math.max(span(s.wall_ms), span(s.cpu_ms)), y: i * row + 14},
        `${short(s.wall_ms / 1e3)} s, all threads ${short(s.cpu_ms / 1e3)} s`));
  });
  section('stages').append(svg);
  const rows = stages.map((s, i) => [s.stage, figure(`stages.${i}.wall_ms`), figure(`stages.${i}.cpu_ms`),
                                     figure(`stages.${i}.peak_mib`), s.in, s.out, s.unit, s.quality]);
  section('stages').append(table(['stage', 'ms', 'ms of all threads', 'MiB so far', 'in', 'out', '', ''], rows));
}

// An image of the pictures, drawn into a canvas when it is there.
function drawn(url) {
  const canvas = element('canvas');
  const image = new Image();
  canvas.ready = new Promise((done) => {
    image.onload = () => {
      canvas.width = image.width;
      canvas.height = image.height;
      canvas.getContext('2d').drawImage(image, 0, 0);
      done(canvas);
    };
  });
  image.src = url;
  return canvas;
}

// Charts have colours that neighbours in number do not share.
const hue = (chart) => `hsl(${(chart * 137.5) % 360} 55% 55%)`;

// Makes the chart under the pointer stand out. The map holds chart numbers + 1 as colours.
async function watch(base, map, over, caption) {
  await Promise.all([base?.ready, map.ready].filter(Boolean));
  const {width, height} = map;
  const data = map.getContext('2d').getImageData(0, 0, width, height).data;
  const chart = (i) => data[4 * i] * 65536 + data[4 * i + 1] * 256 + data[4 * i + 2] - 1;
  over.width = width;
  over.height = height;
  const context = over.getContext('2d');
  const probe = document.createElement('canvas').getContext('2d');
  const paint = (chosen) => {
    const image = context.createImageData(width, height);
    for (let i = 0; i < width * height; ++i) {
      const c = chart(i);
      if (c < 0 || (base && c !== chosen)) continue;
      const edge = c !== chart(i - 1) || c !== chart(i + 1) || c !== chart(i - width) || c !== chart(i + width);
      probe.fillStyle = hue(c);
      const value = parseInt(probe.fillStyle.slice(1), 16);
      const strong = c === chosen;
      image.data.set(strong && base ? [255, 200, 0, edge ? 255 : 60]
                                    : [value >> 16, (value >> 8) & 255, value & 255, strong ? 255 : 190], 4 * i);
    }
    context.putImageData(image, 0, 0);
  };
  paint(-1);
  const plain = caption.textContent;
  let last = -1;
  over.onpointermove = (event) => {
    const box = over.getBoundingClientRect();
    const x = Math.floor((event.clientX - box.left) / box.width * width);
    const y = Math.floor((event.clientY - box.top) / box.height * height);
    const c = chart(y * width + x);
    if (c === last) return;
    last = c;
    paint(c);
    const found = report.charts.charts[c];
    caption.textContent = found ? `chart ${c}: ${short(found.triangles)} triangles, ${short(found.area)} square units, ` +
        `stretch ${short(found.distortion.stretch_l2)}` : plain;
  };
  over.onpointerleave = () => { last = -1; paint(-1); caption.textContent = plain; };
}

function showPages() {
  const pages = report.packing?.pages ?? [];
  if (pages.length === 0) return remove('pages');
  const row = element('div', {class: 'row'});
  pages.forEach((page, i) => {
    const picture = pictures.pages[i];
    const psnr = page.compression_psnr === null || page.compression_psnr === undefined
        ? '' : `, ${short(page.compression_psnr)} dB against lossless`;
    const caption = element('figcaption', {}, `page ${i}: ${page.width} x ${page.height}, ` +
        `${short(page.charts)} charts` + (page.bytes ? `, ${short(page.bytes)} bytes${psnr}` : ''));
    const frame = element('div', {class: 'page'});
    const base = picture.page ? drawn(picture.page) : null;
    const over = element('canvas');
    if (base) frame.append(base);
    frame.append(over);
    watch(base, drawn(picture.charts), over, caption);
    row.append(element('figure', {}, frame, caption));
  });
  section('pages').append(row, element('p', {class: 'note'}, 'The chart under the pointer is named.'));
}

const colour = (c) => `rgb(${c.map((v) => Math.round(255 * v)).join(' ')})`;

function showError() {
  const error = report.error;
  if (!error) return remove('error');
  const keys = ['psnr', 'psnr_with_unlit', 'rmse', 'rmse_display', 'p95', 'p999', 'max',
                'samples_lit', 'samples_unlit', 'samples_clipped'];
  section('error').append(table(['figure', 'value'], keys.map((k) => [k, figure(`error.${k}`)])));
  section('error').append(element('h3', {}, 'Its worst places, as the pages show them'));
  const row = element('div', {class: 'row worst'});
  error.worst.forEach((place, i) => {
    const canvas = drawn(pictures.worst[i]);
    canvas.ready.then(() => {
      const context = canvas.getContext('2d');
      context.strokeStyle = '#ff2ea6';
      context.strokeRect(canvas.width / 2 - 3, canvas.height / 2 - 3, 6, 6);
    });
    const swatch = (c) => element('span', {class: 'swatch', style: `background:${colour(c)}`});
    row.append(element('figure', {}, canvas,
        element('figcaption', {}, `page ${place.page}, texel ${place.texel.map(Math.floor).join(', ')}: off by `,
            figure(`error.worst.${i}.error`, 255), ' of 255 ', swatch(place.wanted), ' wanted ',
            swatch(place.shown), ' shown')));
  });
  section('error').append(row);
}

// A histogram of about 24 bars; with `log`, of equal ratios.
function histogram(title, values, log) {
  const finite = values.filter((v) => Number.isFinite(v) && (!log || v > 0));
  const figureOf = element('figure', {}, element('h3', {}, title));
  if (finite.length === 0) return figureOf;
  const f = log ? Math.log10 : (v) => v, back = log ? (v) => 10 ** v : (v) => v;
  let low = f(Math.min(...finite)), high = f(Math.max(...finite));
  if (!(high > low)) { low -= 0.5; high += 0.5; }
  const count = 24, bars = Array(count).fill(0), width = 300, height = 110, floor = 90;
  for (const v of finite) ++bars[Math.min(count - 1, Math.floor((f(v) - low) / (high - low) * count))];
  const most = Math.max(...bars);
  const svg = shape('svg', {width, height, role: 'img', 'aria-label': title});
  bars.forEach((n, i) => {
    const h = n === 0 ? 0 : Math.max(1, n / most * (floor - 14));
    const bar = shape('rect', {class: 'bar', x: i * width / count + 1, y: floor - h, width: width / count - 2, height: h});
    bar.append(shape('title', {}, `${n}: ${short(back(low + (high - low) * i / count))} to ` +
        `${short(back(low + (high - low) * (i + 1) / count))}`));
    svg.append(bar);
  });
  svg.append(shape('line', {class: 'axis', x1: 0, x2: width, y1: floor, y2: floor}));
  svg.append(shape('text', {x: 0, y: height - 6}, short(back(low))));
  svg.append(shape('text', {x: width, y: height - 6, 'text-anchor': 'end'}, short(back(high))));
  svg.append(shape('text', {x: 0, y: 10}, `${short(most)} at most`));
  figureOf.append(svg);
  return figureOf;
}

function showCharts() {
  const charts = report.charts?.charts;
  if (!charts) return remove('charts');
  const unit = report.scene.metres_per_unit;
  const row = element('div', {class: 'row'});
  row.append(histogram('area, m²', charts.map((c) => c.area * unit * unit), true));
  row.append(histogram('stretch (L2; 1 is perfect)', charts.map((c) => c.distortion.stretch_l2), false));
  row.append(histogram('stretch that 99.9 % keep', charts.map((c) => c.distortion.stretch_999), false));
  if (charts.some((c) => c.texels_per_unit))
    row.append(histogram('texels a metre', charts.map((c) => c.texels_per_unit / unit), true));
  section('charts').append(row);
  const keys = ['count', 'planar', 'seam_length', 'surface_area', 'distortion.stretch_l2', 'distortion.stretch_999',
                'distortion.flips'];
  section('charts').append(table(['figure', 'value'], keys.map((k) => [k, figure(`charts.${k}`)])));
}

// Every evaluation of F: the groups that first-fit decreasing needs at a capacity.
function showGrouping() {
  const g = report.grouping;
  if (!g || g.trace.length === 0) return remove('grouping');
  const width = 620, height = 240, left = 46, right = 12, top = 14, floor = height - 34;
  const points = [...g.trace].sort((a, b) => a[0] - b[0]);
  const xs = points.map((p) => p[0]).concat(g.capacity);
  const low = Math.min(...xs), high = Math.max(...xs), most = Math.max(...points.map((p) => p[1])) + 0.5;
  const x = (v) => left + (high > low ? (v - low) / (high - low) : 0.5) * (width - left - right);
  const y = (v) => floor - v / most * (floor - top);
  const svg = shape('svg', {width, height, role: 'img', 'aria-label': 'groups by capacity'});
  svg.append(shape('line', {class: 'axis', x1: left, x2: width, y1: floor, y2: floor}));
  svg.append(shape('line', {class: 'axis', x1: left, x2: left, y1: top, y2: floor}));
  svg.append(shape('line', {class: 'limit', x1: x(g.capacity), x2: x(g.capacity), y1: top, y2: floor}));
  svg.append(shape('text', {x: x(g.capacity) + (x(g.capacity) > width / 2 ? -4 : 4), y: top + 8,
                            'text-anchor': x(g.capacity) > width / 2 ? 'end' : 'start'}, `A = ${short(g.capacity)}`));
  svg.append(shape('polyline', {class: 'curve', points: points.map((p) => `${x(p[0])},${y(p[1])}`).join(' ')}));
  g.trace.forEach((p, i) => {
    const dot = shape('circle', {class: 'bar', cx: x(p[0]), cy: y(p[1]), r: 3});
    dot.append(shape('title', {}, `step ${i + 1}: F(${short(p[0])}) = ${p[1]}`));
    svg.append(dot);
    if (i < 12) svg.append(shape('text', {x: x(p[0]) + 4, y: y(p[1]) - 5}, String(i + 1)));
  });
  for (let n = 1; n <= most; n += Math.max(1, Math.round(most / 6)))
    svg.append(shape('text', {x: left - 6, y: y(n) + 4, 'text-anchor': 'end'}, String(n)));
  svg.append(shape('text', {x: left, y: height - 16}, short(low)));
  svg.append(shape('text', {x: width - right, y: height - 16, 'text-anchor': 'end'}, short(high)));
  svg.append(shape('text', {x: (left + width) / 2, y: height - 4, 'text-anchor': 'middle'}, 'capacity A, texels'));
  svg.append(shape('text', {x: 4, y: top + 2}, 'F(A)'));
  section('grouping').append(svg, element('p', {class: 'note'},
      'Each dot is one evaluation: the groups that first-fit decreasing needs at this capacity. The first are numbered.'));
  const keys = ['groups', 'capacity', 'largest_group', 'imbalance', 'lower_bound', 'upper_bound'];
  section('grouping').append(table(['figure', 'value'], keys.map((k) => [k, figure(`grouping.${k}`)])));
}

function showFiles() {
  const files = report.files ?? [];
  if (files.length === 0) return remove('files');
  section('files').append(table(['file', 'bytes'], files.map((f, i) => [f.file, figure(`files.${i}.bytes`)])));
}

showHead();
showAdvice();
showAsked();
showPlan();
showStages();
showPages();
showError();
showCharts();
showGrouping();
showFiles();
section('json').textContent = JSON.stringify(report, null, 1);
