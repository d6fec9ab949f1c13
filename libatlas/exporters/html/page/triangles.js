// A tree of boxes around triangles: what a ray meets, and which triangles are near. The function also
// runs in a Worker, so it uses nothing outside of itself.
function triangleTools() {
  const kLeaf = 4, kBins = 12;

  function bounds(positions, indices) {
    const count = indices.length / 3;
    const boxes = new Float32Array(6 * count);
    for (let t = 0; t < count; ++t)
      for (let axis = 0; axis < 3; ++axis) {
        const a = positions[3 * indices[3 * t] + axis];
        const b = positions[3 * indices[3 * t + 1] + axis];
        const c = positions[3 * indices[3 * t + 2] + axis];
        boxes[6 * t + axis] = Math.min(a, b, c);
        boxes[6 * t + 3 + axis] = Math.max(a, b, c);
      }
    return boxes;
  }

  // Returns {boxes, links, order}. Node n has its box in boxes[6 n ...]. links[2 n] is its first
  // child, the second follows that; or in a leaf, with links[2 n + 1] > 0 triangles, its place in
  // `order`.
  function build(positions, indices) {
    const count = indices.length / 3;
    const of = bounds(positions, indices);
    const order = new Uint32Array(count).map((_, i) => i);
    const boxes = new Float32Array(12 * Math.max(1, count));
    const links = new Int32Array(4 * Math.max(1, count));
    let nodes = 1;
    const stack = [[0, 0, count]];
    while (stack.length) {
      const [node, begin, end] = stack.pop();
      const middle = fit(of, order, boxes.subarray(6 * node, 6 * node + 6), begin, end);
      if (middle < 0) {
        links[2 * node] = begin;
        links[2 * node + 1] = end - begin;
        continue;
      }
      links[2 * node] = nodes;
      stack.push([nodes, begin, middle], [nodes + 1, middle, end]);
      nodes += 2;
    }
    return {boxes: boxes.slice(0, 6 * nodes), links: links.slice(0, 2 * nodes), order};
  }

  // Sets the box of a node and divides its triangles. Returns where the second half begins, or -1.
  function fit(of, order, box, begin, end) {
    const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    box.fill(Infinity, 0, 3).fill(-Infinity, 3, 6);
    for (let i = begin; i < end; ++i) {
      const at = 6 * order[i];
      for (let k = 0; k < 3; ++k) {
        box[k] = Math.min(box[k], of[at + k]);
        box[3 + k] = Math.max(box[3 + k], of[at + 3 + k]);
        const centre = of[at + k] + of[at + 3 + k];
        low[k] = Math.min(low[k], centre);
        high[k] = Math.max(high[k], centre);
      }
    }
    if (end - begin <= kLeaf) return -1;
    let axis = 0;
    for (let k = 1; k < 3; ++k) if (high[k] - low[k] > high[axis] - low[axis]) axis = k;
    if (!(high[axis] > low[axis])) return -1;
    const scale = kBins / (high[axis] - low[axis]) * 0.9999;
    const bin = (i) =>
      Math.floor((of[6 * order[i] + axis] + of[6 * order[i] + 3 + axis] - low[axis]) * scale);
    const cut = bestCut(of, order, bin, begin, end);
    let i = begin, j = end;
    while (i < j) {
      if (bin(i) < cut) ++i;
      else [order[i], order[j]] = [order[--j], order[i]];
    }
    return i;
  }

  // Returns the bin before which halves have the least sum of surface times triangles.
  function bestCut(of, order, bin, begin, end) {
    const counts = new Uint32Array(kBins);
    const boxes = new Float32Array(6 * kBins);
    for (let b = 0; b < kBins; ++b)
      boxes.fill(Infinity, 6 * b, 6 * b + 3).fill(-Infinity, 6 * b + 3, 6 * b + 6);
    const grow = (box, at, from, other) => {
      for (let k = 0; k < 3; ++k) {
        box[at + k] = Math.min(box[at + k], from[other + k]);
        box[at + 3 + k] = Math.max(box[at + 3 + k], from[other + 3 + k]);
      }
    };
    for (let i = begin; i < end; ++i) {
      const b = bin(i);
      ++counts[b];
      grow(boxes, 6 * b, of, 6 * order[i]);
    }
    const costs = new Float64Array(kBins + 1);
    for (const up of [true, false]) {
      const box = new Float32Array(6).fill(Infinity, 0, 3).fill(-Infinity, 3, 6);
      let sum = 0;
      for (let s = 0; s < kBins; ++s) {
        const b = up ? s : kBins - 1 - s;
        grow(box, 0, boxes, 6 * b);
        sum += counts[b];
        const x = box[3] - box[0], y = box[4] - box[1], z = box[5] - box[2];
        const cost = sum > 0 ? sum * (x * y + y * z + z * x) : Infinity;
        costs[up ? b + 1 : b] += cost;
      }
    }
    let best = 1;
    for (let b = 2; b < kBins; ++b) if (costs[b] < costs[best]) best = b;
    return best;
  }

  return {build};
}

class TriangleTree {
  constructor(mesh, {boxes, links, order}) {
    Object.assign(this, {mesh, boxes, links, order, stack: new Int32Array(256)});
  }

  corner(triangle, k) {
    const at = 3 * this.mesh.indices[3 * triangle + k];
    const p = this.mesh.positions;
    return [p[at], p[at + 1], p[at + 2]];
  }

  // Returns the first triangle that the ray meets within `reach` lengths of `along`, as {triangle,
  // distance, weights}, or null. With `fronts`, only those whose front it meets.
  ray(from, along, {reach = Infinity, fronts = false} = {}) {
    const inverse = along.map((x) => 1 / x);
    let hit = null, depth = 0;
    this.stack[depth++] = 0;
    while (depth > 0) {
      const node = this.stack[--depth];
      const limit = hit ? hit.distance : reach;
      if (!this.meetsBox(node, from, inverse, limit)) continue;
      const first = this.links[2 * node], count = this.links[2 * node + 1];
      if (count === 0) {
        this.stack[depth++] = first;
        this.stack[depth++] = first + 1;
      }
      for (let i = first; i < first + count; ++i)
        hit = this.meet(this.order[i], from, along, {reach: hit ? hit.distance : reach, fronts}) || hit;
    }
    return hit;
  }

  meetsBox(node, from, inverse, limit) {
    let near = 0, far = limit;
    for (let k = 0; k < 3; ++k) {
      const a = (this.boxes[6 * node + k] - from[k]) * inverse[k];
      const b = (this.boxes[6 * node + 3 + k] - from[k]) * inverse[k];
      if (a !== a || b !== b) continue;  // on a side, along it
      near = Math.max(near, Math.min(a, b));
      far = Math.min(far, Math.max(a, b));
    }
    return near <= far * 1.00001;
  }

  meet(triangle, from, along, {reach, fronts}) {
    const a = this.corner(triangle, 0);
    const e1 = sub(this.corner(triangle, 1), a), e2 = sub(this.corner(triangle, 2), a);
    const p = cross(along, e2);
    const det = dot(e1, p);
    if (det === 0) return null;
    if (det < 0 && (fronts || this.frontOnly(triangle))) return null;
    const s = sub(from, a);
    const u = dot(s, p) / det;
    if (u < 0 || u > 1) return null;
    const q = cross(s, e1);
    const v = dot(along, q) / det;
    if (v < 0 || u + v > 1) return null;
    const distance = dot(e2, q) / det;
    if (!(distance > 0 && distance < reach)) return null;
    return {triangle, distance, weights: [1 - u - v, u, v]};
  }

  partOf(triangle) {
    return this.mesh.parts[this.mesh.partOf[triangle]];
  }
  frontOnly(triangle) {
    return this.mesh.anyOneSided && this.partOf(triangle).oneSided;
  }

  normal(triangle) {
    const a = this.corner(triangle, 0);
    return normalized(cross(sub(this.corner(triangle, 1), a), sub(this.corner(triangle, 2), a)));
  }

  // Calls visit(triangle) for all triangles whose leaf meets the box.
  near(low, high, visit) {
    let depth = 0;
    this.stack[depth++] = 0;
    while (depth > 0) {
      const node = this.stack[--depth];
      let apart = false;
      for (let k = 0; k < 3; ++k)
        apart = apart || this.boxes[6 * node + k] > high[k] || this.boxes[6 * node + 3 + k] < low[k];
      if (apart) continue;
      const first = this.links[2 * node], count = this.links[2 * node + 1];
      if (count === 0) {
        this.stack[depth++] = first;
        this.stack[depth++] = first + 1;
      }
      for (let i = first; i < first + count; ++i) visit(this.order[i]);
    }
  }

  // Returns the point of a triangle that is nearest to p (Ericson, Real-Time Collision Detection,
  // section 5.1.5).
  nearestPoint(triangle, p) {
    const a = this.corner(triangle, 0), b = this.corner(triangle, 1), c = this.corner(triangle, 2);
    const ab = sub(b, a), ac = sub(c, a), ap = sub(p, a);
    const d1 = dot(ab, ap), d2 = dot(ac, ap);
    if (d1 <= 0 && d2 <= 0) return a;
    const bp = sub(p, b), d3 = dot(ab, bp), d4 = dot(ac, bp);
    if (d3 >= 0 && d4 <= d3) return b;
    const vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) return add(a, scaled(ab, d1 / (d1 - d3)));
    const cp = sub(p, c), d5 = dot(ab, cp), d6 = dot(ac, cp);
    if (d6 >= 0 && d5 <= d6) return c;
    const vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0) return add(a, scaled(ac, d2 / (d2 - d6)));
    const va = d3 * d6 - d5 * d4;
    if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0)
      return add(b, scaled(sub(c, b), (d4 - d3) / (d4 - d3 + (d5 - d6))));
    const sum = va + vb + vc;
    if (sum === 0) return a;
    return add(a, add(scaled(ab, vb / sum), scaled(ac, vc / sum)));
  }
}
