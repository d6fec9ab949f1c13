// Values of the light: under the pointer, and on a grid over a rectangle that is drawn on a face.

// The distance of the points of a grid over a rectangle, in metres (EN 12464-1, section 4.4): it
// depends on the longer side, or on the shorter one where that is half as long or less.
function gridSpacing(sides) {
  const longer = Math.max(...sides), shorter = Math.min(...sides);
  const d = longer / shorter >= 2 ? shorter : longer;
  return Math.min(10, 0.2 * 5 ** Math.log10(d));
}

class Measuring {
  constructor(viewer) {
    Object.assign(this, {viewer, active: false, first: null, rectangle: null, result: null, last: null});
  }

  // The panel's part.
  controls() {
    const button = element('button', {type: 'button', className: 'wide',
      textContent: this.active ? 'Draw on a surface …' : 'Measure a rectangle'});
    button.setAttribute('aria-pressed', this.active);
    button.addEventListener('click', () => {
      this.active = !this.active;
      this.viewer.refresh();
    });
    const content = [button];
    if (!this.result) {
      content.push(element('p', {textContent:
        'Drag on a surface, or press M at one corner and at the other. The points are those of EN 12464-1.'}));
      return content;
    }
    const {mean, least, most, points, missed, sides, spacing} = this.result;
    const {unit} = this.viewer.quantity;
    const line = (name, text) => element('tr', {}, element('td', {textContent: name}),
      element('td', {textContent: text}));
    content.push(element('table', {},
      line('Size', sides.map((s) => shortNumber(s) + ' m').join(' × ')),
      line('Points', `${points}, ${shortNumber(spacing)} m apart`),
      line('Mean', `${shortNumber(mean)} ${unit}`),
      line('Least', `${shortNumber(least)} ${unit}`),
      line('Greatest', `${shortNumber(most)} ${unit}`),
      line('Uniformity', mean > 0 ? (least / mean).toFixed(2) : '–')));
    if (missed) content.push(element('p', {textContent: `${missed} points of the grid have no value.`}));
    const clear = element('button', {type: 'button', className: 'wide', textContent: 'Remove'});
    clear.addEventListener('click', () => {
      this.rectangle = this.result = this.first = null;
      this.viewer.refresh();
    });
    content.push(clear);
    return content;
  }

  begin(x, y) {
    this.first = this.viewer.pick(x, y);
    this.rectangle = this.result = null;
  }

  to(x, y) {
    if (!this.first) return;
    const {from, along} = this.viewer.rayAt(x, y);
    const normal = this.first.normal;
    const slope = dot(along, normal);
    const distance = dot(sub(this.first.position, from), normal) / slope;
    if (!(distance > 0 && isFinite(distance))) return;
    this.rectangle = rectangleOn(this.first.position, add(from, scaled(along, distance)), normal);
  }

  end() {
    this.active = false;
    if (this.rectangle) this.measure();
    this.viewer.refresh();
  }

  // Of the key M: sets the first corner, then the second.
  corner() {
    if (this.viewer.view !== 'falseColours') this.viewer.show('falseColours');
    const [x, y] = this.viewer.pointer || this.viewer.middleOfPicture();
    if (this.first && !this.rectangle) {
      this.to(x, y);
      this.end();
    } else {
      this.begin(x, y);
    }
    this.viewer.changed();
  }

  // Values are read where the surface is within a small way of the rectangle.
  measure() {
    const {viewer} = this, {corner, u, v, normal} = this.rectangle;
    const sides = [length(u), length(v)];
    const spacing = gridSpacing(sides);
    const counts = sides.map((s) => clamp(Math.ceil(s / spacing), 2, 100));
    const reach = Math.max(1e-3 * viewer.motion.size, 0.05 * Math.max(...sides));
    const values = [];
    let missed = 0;
    this.points = [];
    for (let j = 0; j < counts[1]; ++j)
      for (let i = 0; i < counts[0]; ++i) {
        const p = add(corner, add(scaled(u, (i + 0.5) / counts[0]), scaled(v, (j + 0.5) / counts[1])));
        const hit = viewer.tree.ray(add(p, scaled(normal, reach)), scaled(normal, -1), {reach: 2 * reach});
        const value = hit && viewer.reading(hit).value;
        this.points.push(p);
        if (value === null || value === undefined) ++missed;
        else values.push(value);
      }
    const mean = values.reduce((a, b) => a + b, 0) / values.length;
    this.result = values.length === 0 ? null : {mean, least: Math.min(...values), missed,
      most: Math.max(...values), points: values.length, sides, spacing};
  }

  // Draws the rectangle and its points onto the picture.
  draw(context, project) {
    if (this.first && !this.rectangle) this.dot(context, project(this.first.position), 4);
    if (!this.rectangle) return;
    const {corner, u, v} = this.rectangle;
    const corners = [corner, add(corner, u), add(corner, add(u, v)), add(corner, v)].map(project);
    if (corners.some((c) => !c)) return;
    context.beginPath();
    corners.forEach((c) => context.lineTo(...c));
    context.closePath();
    for (const [style, width] of [['rgba(0,0,0,.7)', 4], ['#fff', 2]]) {
      Object.assign(context, {strokeStyle: style, lineWidth: width});
      context.stroke();
    }
    if (this.result) for (const p of this.points) this.dot(context, project(p), 1.6);
  }

  dot(context, place, radius) {
    if (!place) return;
    context.beginPath();
    context.arc(...place, radius, 0, 2 * Math.PI);
    Object.assign(context, {fillStyle: '#fff', strokeStyle: 'rgba(0,0,0,.7)', lineWidth: 1});
    context.fill();
    context.stroke();
  }
}

// Returns the rectangle with these opposite corners on the plane of `normal`. Its sides are level or
// upright; on the floor they follow the axes.
function rectangleOn(a, b, normal) {
  const level = Math.abs(normal[1]) > 0.99 ? [1, 0, 0] : normalized(cross([0, 1, 0], normal));
  const side = normalized(sub(level, scaled(normal, dot(level, normal))));
  const other = cross(normal, side);
  const diagonal = sub(b, a);
  return {corner: a, u: scaled(side, dot(diagonal, side)), v: scaled(other, dot(diagonal, other)), normal};
}
