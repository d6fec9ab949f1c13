// Reads what an OBJ file says about one mesh: positions, given uvs and polygons. The tests and the benchmark use it, too.
export function readObj(text) {
  const positions = [], texcoords = [], indices = [], texcoordIndices = [], polygonSizes = [];
  const index = (word, count) => {
    const number = Number.parseInt(word, 10);
    return Number.isNaN(number) ? 0xffffffff : number < 0 ? count + number : number - 1;
  };
  for (const line of text.replace(/\\\r?\n/g, " ").split(/\r?\n/)) {
    const words = line.trim().split(/\s+/);
    if (words[0] === "v") positions.push(+words[1], +words[2], +words[3]);
    else if (words[0] === "vt") texcoords.push(+words[1], +(words[2] ?? 0));
    else if (words[0] === "f" && words.length > 3) {
      for (const word of words.slice(1)) {
        const [position, texcoord] = word.split("/");
        indices.push(index(position, positions.length / 3));
        texcoordIndices.push(index(texcoord, texcoords.length / 2));
      }
      polygonSizes.push(words.length - 1);
    }
  }
  const mesh = { positions: new Float32Array(positions), indices: new Uint32Array(indices) };
  if (polygonSizes.some((size) => size !== 3)) mesh.polygonSizes = new Uint32Array(polygonSizes);
  if (texcoords.length > 0) {
    mesh.texcoords = new Float32Array(texcoords);
    mesh.texcoordIndices = new Uint32Array(texcoordIndices);
  }
  return mesh;
}

// The same mesh with each polygon as a fan of triangles.
export function fans(mesh) {
  if (!mesh.polygonSizes) return mesh;
  const order = [];
  let first = 0;
  for (const size of mesh.polygonSizes) {
    for (let k = 2; k < size; ++k) order.push(first, first + k - 1, first + k);
    first += size;
  }
  const { polygonSizes, ...rest } = mesh;
  for (const name of ["indices", "texcoordIndices"]) {
    if (mesh[name]) rest[name] = Uint32Array.from(order, (corner) => mesh[name][corner]);
  }
  return rest;
}
