// How the visitor moves: on foot, flying, or around an object.

const kGravity = 9.81, kRunning = 2.5, kTurning = 1.6;  // m/s², factor, radians a second
const kMostPitch = 1.55;

// What all ways of moving share. `move` holds what the keys and thumbs ask for, each -1..1.
class Motion {
  constructor(world, mesh) {
    Object.assign(this, {world, mesh, tree: null, mode: 'walk', fall: 0});
    this.lag = 0;  // how far the picture is behind the eyes, which have climbed a step
    this.size = length(sub(mesh.high, mesh.low)) || 1;
    this.middle = scaled(add(mesh.low, mesh.high), 0.5);
    this.move = {ahead: 0, aside: 0, rise: 0, turn: 0, nod: 0, run: false};
    this.scale = world.visitor.height / 1.6;  // of a person
    this.height = world.visitor.height;
    this.radius = Math.min(0.2 * this.scale, world.visitor.width);
    this.step = 0.22 * this.height;
    this.reset();
  }

  reset() {
    const {position, direction, fov} = this.world.start;
    this.setView(position, direction);
    this.fov = fov;
    this.setMode(this.world.inside ? 'walk' : 'orbit');
  }

  setView(eye, direction) {
    Object.assign(this, {eye: [...eye], yaw: yawOf(direction),
      pitch: clamp(pitchOf(direction), -kMostPitch, kMostPitch), fall: 0, lag: 0});
    this.distance = this.mode === 'orbit' || !this.world.inside
      ? Math.max(1e-3 * this.size, length(sub(this.middle, this.eye))) : 2 * this.scale;
  }

  setMode(mode) {
    if (mode === 'orbit' && this.mode !== 'orbit') {
      // Around what is in the middle of the picture.
      const hit = this.tree && this.tree.ray(this.eye, this.ahead());
      if (this.world.inside || hit)
        this.distance = hit ? Math.max(hit.distance, 1e-3 * this.size) : 2 * this.scale;
    }
    this.mode = mode;
    this.fall = 0;
  }

  // An overview from above, and a view from outside.
  goOutside(direction) {
    this.setMode('orbit');
    const ahead = normalized(direction);
    this.distance = 0.5 * this.size / Math.sin(this.fov / 2);
    this.setView(sub(this.middle, scaled(ahead, this.distance)), ahead);
    this.distance = 0.5 * this.size / Math.sin(this.fov / 2);
  }

  ahead() {
    return directionOf(this.yaw, this.pitch);
  }
  target() {
    return add(this.eye, scaled(this.ahead(), this.distance));
  }

  // Turns the view by angles; in orbit, around its target.
  look(yaw, pitch) {
    const target = this.target();
    this.yaw += yaw;
    this.pitch = clamp(this.pitch + pitch, -kMostPitch, kMostPitch);
    if (this.mode === 'orbit') this.eye = sub(target, scaled(this.ahead(), this.distance));
  }

  zoom(factor) {
    const target = this.target();
    this.distance = clamp(this.distance * factor, 1e-4 * this.size, 20 * this.size);
    this.eye = sub(target, scaled(this.ahead(), this.distance));
  }

  // Moves the view sideways by shares of the picture's height.
  pan(right, up) {
    const across = 2 * this.distance * Math.tan(this.fov / 2);
    const side = [Math.cos(this.yaw), 0, -Math.sin(this.yaw)];
    const above = cross(side, this.ahead());
    this.eye = add(this.eye, add(scaled(side, right * across), scaled(above, up * across)));
  }

  // Returns whether anything moves.
  advance(seconds) {
    const {ahead, aside, rise, turn, nod} = this.move;
    const asked = ahead || aside || rise || turn || nod;
    if (turn || nod) this.look(turn * kTurning * seconds, nod * kTurning * seconds);
    if (this.mode === 'orbit') {
      if (ahead) this.zoom(Math.exp(-1.2 * ahead * seconds));
      if (aside || rise) this.pan(0.6 * aside * seconds, 0.6 * rise * seconds);
      return Boolean(asked);
    }
    const speed = this.world.visitor.speed * (this.move.run ? kRunning : 1) * seconds;
    if (this.mode === 'fly') {
      const way = add(scaled(this.ahead(), ahead),
        [aside * Math.cos(this.yaw), rise, -aside * Math.sin(this.yaw)]);
      this.eye = add(this.eye, scaled(way, 1.5 * speed));
      return Boolean(asked);
    }
    this.lag *= Math.exp(-10 * seconds);
    if (this.lag < 1e-3 * this.height) this.lag = 0;
    return this.walk(seconds, speed) || this.lag > 0 || Boolean(asked);
  }

  walk(seconds, speed) {
    if (!this.tree) return false;
    const {ahead, aside} = this.move;
    const sin = Math.sin(this.yaw), cos = Math.cos(this.yaw);
    const way = [speed * (aside * cos - ahead * sin), 0, speed * (-aside * sin - ahead * cos)];
    const pieces = Math.ceil(length(way) / (0.4 * this.radius));
    for (let i = 0; i < pieces; ++i) {
      this.eye = add(this.eye, scaled(way, 1 / pieces));
      this.keepOut();
      this.keepOnFloor(0);
    }
    return this.keepOnFloor(seconds);
  }

  // Pushes the body out of walls. It is three spheres, from above what feet step over to the eyes.
  keepOut() {
    const low = this.step + this.radius, high = Math.max(this.height, low + 1e-9);
    const kPasses = 4;  // corners take two, and the spheres push each other back
    for (let pass = 0; pass < kPasses; ++pass) {
      let pushed = false;
      for (const above of [low, (low + high) / 2, high]) {
        const away = this.nearestWall([this.eye[0], this.eye[1] - this.height + above, this.eye[2]]);
        if (!away) continue;
        // So far that the distance is the radius again.
        const flat = Math.hypot(away[0], away[2]);
        const push = (Math.sqrt(this.radius ** 2 - away[1] ** 2) - flat) / flat;
        if (push < 1e-6) continue;
        this.eye[0] += push * away[0];
        this.eye[2] += push * away[2];
        pushed = true;
      }
      if (!pushed) return;
    }
  }

  // Returns the way to a place from the nearest point that is within the radius, or null. What is
  // nearly straight above or below is no wall.
  nearestWall(centre) {
    const r = this.radius;
    let nearest = r, result = null;
    this.tree.near(centre.map((x) => x - r), centre.map((x) => x + r), (triangle) => {
      const away = sub(centre, this.tree.nearestPoint(triangle, centre));
      const distance = length(away), flat = Math.hypot(away[0], away[2]);
      if (distance >= nearest || flat < 0.3 * distance || flat === 0) return;
      nearest = distance;
      result = away;
    });
    return result;
  }

  // Steps up what is low enough, and falls. Where there is no floor below, nothing pulls.
  keepOnFloor(seconds) {
    const knee = [this.eye[0], this.eye[1] - this.height + this.step, this.eye[2]];
    const hit = this.tree.ray(knee, [0, -1, 0]);
    if (!hit) {
      this.fall = 0;
      return false;
    }
    const gap = hit.distance - this.step;  // below the feet
    if (gap <= 1e-4 * this.height) {
      this.fall = 0;
      this.eye[1] -= gap;
      if (-gap > 1e-3 * this.height) this.lag -= gap;
      return -gap > 1e-3 * this.height;
    }
    if (seconds === 0) return false;
    this.fall += kGravity * this.scale * seconds;
    this.eye[1] -= Math.min(gap, this.fall * seconds);
    return true;
  }

  camera() {
    const outside = Math.max(...[0, 1, 2].map((k) =>
      Math.max(this.mesh.low[k] - this.eye[k], this.eye[k] - this.mesh.high[k], 0)));
    const far = 2.2 * this.size + length(sub(this.middle, this.eye));
    const near = Math.max(outside * 0.5, Math.min(0.05 * this.scale, this.radius / 2), far * 2e-6);
    const eye = [this.eye[0], this.eye[1] - this.lag, this.eye[2]];
    // From outside, rooms are seen through the backs of their walls.
    const fronts = this.world.inside && outside > 0;
    return {eye, yaw: this.yaw, pitch: this.pitch, fov: this.fov, near, far, fronts};
  }
}
