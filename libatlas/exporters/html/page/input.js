// Keys, mouse and fingers.

const kKeys = {
  KeyW: ['ahead', 1], ArrowUp: ['ahead', 1], KeyS: ['ahead', -1], ArrowDown: ['ahead', -1],
  KeyA: ['aside', -1], KeyD: ['aside', 1], ArrowLeft: ['turn', 1], ArrowRight: ['turn', -1],
  KeyE: ['rise', 1], KeyQ: ['rise', -1], PageUp: ['nod', 1], PageDown: ['nod', -1],
};
const kLookMouse = 0.0022, kLookDrag = 0.004;  // radians a pixel
const kClick = 5;                             // pixels that a click may move

class Input {
  // `actions` has: changed(), hover(x, y), and drag, an object with begin(x, y), to(x, y), end(), or
  // null where the pointer turns the view; allowsLock(), stick(from, to).
  constructor(canvas, motion, actions) {
    Object.assign(this, {canvas, motion, actions, pressed: new Set(), pointers: new Map()});
    window.addEventListener('keydown', (e) => this.key(e, true));
    window.addEventListener('keyup', (e) => this.key(e, false));
    window.addEventListener('blur', () => this.release());
    canvas.addEventListener('pointerdown', (e) => this.down(e));
    canvas.addEventListener('pointermove', (e) => this.moved(e));
    for (const name of ['pointerup', 'pointercancel'])
      canvas.addEventListener(name, (e) => this.up(e));
    canvas.addEventListener('pointerleave', () => actions.hover(null));
    canvas.addEventListener('contextmenu', (e) => e.preventDefault());
    canvas.addEventListener('wheel', (e) => this.wheel(e), {passive: false});
  }

  get locked() {
    return document.pointerLockElement === this.canvas;
  }

  // Keys that a control under the focus needs are left to it.
  key(event, down) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const control = event.target.closest('select, input, [role=radiogroup], dialog');
    if (control && down) return;
    this.motion.move.run = event.shiftKey;
    if (!(event.code in kKeys)) return;
    event.preventDefault();
    if (down) this.pressed.add(event.code);
    else this.pressed.delete(event.code);
    this.sum();
  }

  release() {
    this.pressed.clear();
    this.sum();
  }

  sum() {
    const move = {ahead: 0, aside: 0, rise: 0, turn: 0, nod: 0};
    for (const code of this.pressed) move[kKeys[code][0]] += kKeys[code][1];
    for (const pointer of this.pointers.values())
      if (pointer.stick) {
        move.aside += pointer.stick[0];
        move.ahead -= pointer.stick[1];
      }
    for (const name in move) this.motion.move[name] = clamp(move[name], -1, 1);
    this.actions.changed();
  }

  down(event) {
    this.canvas.focus({preventScroll: true});
    this.canvas.setPointerCapture(event.pointerId);
    const pointer = {x: event.clientX, y: event.clientY, fromX: event.clientX, fromY: event.clientY,
      button: event.button};
    if (event.pointerType !== 'mouse' && this.motion.mode !== 'orbit' && !this.actions.drag &&
        event.clientX < 0.45 * this.canvas.clientWidth) pointer.stick = [0, 0];
    else if (this.actions.drag && event.button === 0 && this.pointers.size === 0) {
      pointer.drags = true;
      this.actions.drag.begin(event.clientX, event.clientY);
    }
    this.pointers.set(event.pointerId, pointer);
    if (pointer.stick) this.actions.stick([pointer.x, pointer.y], [0, 0]);
  }

  moved(event) {
    const pointer = this.pointers.get(event.pointerId);
    if (this.locked) {
      this.motion.look(-kLookMouse * event.movementX, -kLookMouse * event.movementY);
      this.actions.changed();
      return;
    }
    if (event.pointerType === 'mouse') this.actions.hover([event.clientX, event.clientY]);
    if (!pointer) return;
    const dx = event.clientX - pointer.x, dy = event.clientY - pointer.y;
    const before = this.spread();
    Object.assign(pointer, {x: event.clientX, y: event.clientY});
    if (pointer.drags) this.actions.drag.to(pointer.x, pointer.y);
    else if (pointer.stick) this.pushStick(pointer);
    else if (this.motion.mode === 'orbit') this.orbit(pointer, dx, dy, before);
    else this.motion.look(kLookDrag * dx, kLookDrag * dy);
    this.actions.changed();
  }

  pushStick(pointer) {
    const reach = 60;
    const x = pointer.x - pointer.fromX, y = pointer.y - pointer.fromY;
    const over = Math.max(1, Math.hypot(x, y) / reach);
    pointer.stick = [x / reach / over, y / reach / over];
    this.actions.stick([pointer.fromX, pointer.fromY], [x / over, y / over]);
    this.sum();
  }

  // Two fingers zoom and shift, as the wheel and the right button do.
  orbit(pointer, dx, dy, before) {
    const height = this.canvas.clientHeight;
    if (this.pointers.size === 2) {
      const after = this.spread();
      if (before > 0 && after > 0) this.motion.zoom(before / after);
      this.motion.pan(-dx / height / 2, dy / height / 2);
    } else if (pointer.button === 2 || pointer.button === 1) {
      this.motion.pan(-dx / height, dy / height);
    } else {
      this.motion.look(-1.6 * kLookDrag * dx, -1.6 * kLookDrag * dy);
    }
  }

  spread() {
    const [a, b] = [...this.pointers.values()];
    return b ? Math.hypot(a.x - b.x, a.y - b.y) : 0;
  }

  up(event) {
    const pointer = this.pointers.get(event.pointerId);
    if (!pointer) return;
    this.pointers.delete(event.pointerId);
    if (pointer.drags) this.actions.drag?.end();
    if (pointer.stick) {
      this.actions.stick(null);
      this.sum();
    }
    const still = Math.hypot(pointer.x - pointer.fromX, pointer.y - pointer.fromY) < kClick;
    if (still && event.pointerType === 'mouse' && event.button === 0 && !pointer.drags &&
        this.motion.mode !== 'orbit' && this.actions.allowsLock() && !this.locked)
      this.lock();
  }

  // Where a browser refuses, dragging turns the view.
  lock() {
    const asked = this.canvas.requestPointerLock?.();
    asked?.catch?.(() => {});
  }

  wheel(event) {
    event.preventDefault();
    if (this.motion.mode === 'orbit') this.motion.zoom(Math.exp(0.0015 * event.deltaY));
    else if (this.motion.mode === 'fly')
      this.motion.eye = add(this.motion.eye,
        scaled(this.motion.ahead(), -0.003 * event.deltaY * this.motion.scale));
    else return;
    this.actions.changed();
  }
}
