// The controls around the picture.

const at = (id) => document.getElementById(id);

// Returns an element with properties, attributes and children.
function element(name, {attributes = {}, ...properties} = {}, ...children) {
  const result = Object.assign(document.createElement(name), properties);
  for (const [key, value] of Object.entries(attributes)) result.setAttribute(key, value);
  result.append(...children);
  return result;
}

function row(text, control) {
  return element('label', {className: 'row'}, element('span', {textContent: text}), control);
}

function fillSelect(select, entries) {
  select.replaceChildren(...entries.map(([value, text]) =>
    element('option', {value, textContent: text})));
}

// Connects the header, the help and the keys that are no movement.
class Controls {
  // `viewer` has: motion, changed(), setMode(name), show(view), views, places, goTo(index),
  // screenshot(), light (or null).
  constructor(viewer) {
    this.viewer = viewer;
    at('title').textContent = viewer.world.title || 'World';
    fillSelect(at('views'), viewer.views.map((view) => [view.name, view.text]));
    fillSelect(at('places'), [['', '…'], ...viewer.places.map((place, i) => [i, place.text])]);
    at('views').addEventListener('change', () => viewer.show(at('views').value));
    at('places').addEventListener('change', () => {
      viewer.goTo(Number(at('places').value));
      at('places').value = '';
    });
    for (const radio of document.querySelectorAll('#modes input'))
      radio.addEventListener('change', () => viewer.setMode(radio.value));
    at('shot').addEventListener('click', () => viewer.screenshot());
    at('keys').addEventListener('click', () => this.help());
    at('menu').addEventListener('click', () => this.openMenu(!at('tools').classList.contains('open')));
    at('view').addEventListener('pointerdown', () => {
      this.openMenu(false);
      at('hint').hidden = true;
    });
    for (const part of document.querySelectorAll('.of-light')) part.hidden = !viewer.light;
    at('about').textContent = this.about();
    document.addEventListener('pointerlockchange', () => {
      at('cross').hidden = document.pointerLockElement !== at('view');
    });
    window.addEventListener('keydown', (e) => this.key(e));
  }

  about() {
    const {world} = this.viewer;
    const triangles = world.parts.reduce((n, part) => n + part.triangles, 0);
    const pages = world.pages.filter((page) => page.type).length;
    return `${triangles.toLocaleString('en')} triangles` +
      (pages ? `, ${pages} ${pages === 1 ? 'page' : 'pages'} of baked light` : '') + '. Made with libatlas.';
  }

  openMenu(open) {
    at('tools').classList.toggle('open', open);
    at('menu').setAttribute('aria-expanded', open);
  }

  help() {
    this.openMenu(false);
    document.exitPointerLock?.();
    at('help').showModal();
  }

  key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey || event.target.closest('dialog')) return;
    if (event.key === 'Escape' && at('tools').classList.contains('open')) {
      this.openMenu(false);
      at('menu').focus();
    }
    if (event.target.closest('select, input')) return;
    const {viewer} = this;
    const views = viewer.views.map((view) => view.name);
    const actions = {
      '?': () => this.help(), h: () => this.help(), p: () => viewer.screenshot(),
      1: () => viewer.setMode('walk'), 2: () => viewer.setMode('fly'), 3: () => viewer.setMode('orbit'),
      f: () => viewer.setMode(viewer.motion.mode === 'fly' ? 'walk' : 'fly'),
      v: () => viewer.show(views[(views.indexOf(viewer.view) + 1) % views.length]),
      Home: () => viewer.goTo(0),
    };
    if (viewer.light)
      Object.assign(actions, {'+': () => viewer.expose(0.5), '=': () => viewer.expose(0.5),
        '-': () => viewer.expose(-0.5), m: () => viewer.measuring.corner()});
    const action = actions[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (!action) return;
    event.preventDefault();
    action();
  }

  showMode(mode) {
    for (const radio of document.querySelectorAll('#modes input')) radio.checked = radio.value === mode;
  }

  hint() {
    const touch = matchMedia('(pointer: coarse)').matches;
    const mode = this.viewer.motion.mode;
    at('hint').textContent = mode === 'orbit'
      ? (touch ? 'One finger turns, two zoom and shift' : 'Drag to turn, wheel to zoom · ? for all keys')
      : (touch ? 'Left thumb walks, right thumb looks'
        : 'Drag to look, W A S D or arrows to walk · ? for all keys');
    at('hint').hidden = false;
    setTimeout(() => { at('hint').hidden = true; }, 8000);
  }

  stick(from, to) {
    const stick = at('stick');
    stick.hidden = !from;
    if (!from) return;
    Object.assign(stick.style, {left: from[0] + 'px', top: from[1] + 'px'});
    stick.firstElementChild.style.transform = `translate(${to[0]}px, ${to[1]}px)`;
  }
}
