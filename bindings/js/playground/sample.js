// What is shown before a file is opened: a knot whose tube swells and thins.
export function sampleMesh(along = 240, around = 28) {
  const positions = new Float32Array(3 * along * around), indices = new Uint32Array(6 * along * around);
  const middle = (t) => [Math.sin(t) + 2 * Math.sin(2 * t), Math.cos(t) - 2 * Math.cos(2 * t), -1.4 * Math.sin(3 * t)];
  const unit = (v) => v.map((x) => x / Math.hypot(...v));
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  for (let i = 0; i < along; ++i) {
    const t = (2 * Math.PI * i) / along, at = middle(t), next = middle(t + 1e-3);
    const ahead = unit(next.map((x, k) => x - at[k])), side = unit(cross(ahead, unit(at))), up = cross(side, ahead);
    const radius = 0.5 + 0.16 * Math.sin(9 * t);
    for (let j = 0; j < around; ++j) {
      const v = (2 * Math.PI * j) / around, c = radius * Math.cos(v), s = radius * Math.sin(v);
      positions.set(at.map((x, k) => x + c * side[k] + s * up[k]), 3 * (i * around + j));
      const [a, b, right] = [i * around + j, ((i + 1) % along) * around + j, (j + 1) % around];
      const [d, e] = [i * around + right, ((i + 1) % along) * around + right];
      indices.set([a, b, e, a, e, d], 6 * (i * around + j));
    }
  }
  return { positions, indices };
}
