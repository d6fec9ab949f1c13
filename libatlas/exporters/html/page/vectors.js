// Vectors are arrays of three numbers, matrices are columns of sixteen as WebGL reads them.

const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
const sub = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const scaled = (a, s) => [a[0] * s, a[1] * s, a[2] * s];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
];
const length = (a) => Math.hypot(a[0], a[1], a[2]);
const normalized = (a) => scaled(a, 1 / (length(a) || 1));
const clamp = (x, low, high) => Math.min(high, Math.max(low, x));
const luma = (r, g, b) => 0.2126 * r + 0.7152 * g + 0.0722 * b;

// The direction of a heading (yaw, 0 looks along -z, counter-clockwise seen from above) and a pitch.
const directionOf = (yaw, pitch) => [
  -Math.sin(yaw) * Math.cos(pitch),
  Math.sin(pitch),
  -Math.cos(yaw) * Math.cos(pitch),
];
const yawOf = (d) => Math.atan2(-d[0], -d[2]);
const pitchOf = (d) => Math.asin(clamp(d[1] / (length(d) || 1), -1, 1));

// The matrix from the world to what a camera sees: x to the right, y up, looking along -z. The eye
// is left out: it is subtracted before, in double precision.
function turnMatrix(yaw, pitch) {
  const back = scaled(directionOf(yaw, pitch), -1);
  const right = [Math.cos(yaw), 0, -Math.sin(yaw)];
  const up = cross(back, right);
  return [right[0], up[0], back[0], 0, right[1], up[1], back[1], 0, right[2], up[2], back[2], 0,
    0, 0, 0, 1];
}

function perspective(fovY, aspect, near, far) {
  const f = 1 / Math.tan(fovY / 2);
  const d = 1 / (near - far);
  return [f / aspect, 0, 0, 0, 0, f, 0, 0, 0, 0, (near + far) * d, -1, 0, 0, 2 * near * far * d, 0];
}

function multiplied(a, b) {
  const c = new Array(16);
  for (let i = 0; i < 4; ++i)
    for (let j = 0; j < 4; ++j) {
      let sum = 0;
      for (let k = 0; k < 4; ++k) sum += a[4 * k + j] * b[4 * i + k];
      c[4 * i + j] = sum;
    }
  return c;
}
