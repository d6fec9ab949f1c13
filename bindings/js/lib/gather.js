// Values of vertices for the vertices of a result: gather(normals, mesh.vertices, 3).
export function gather(values, vertices, width) {
  const result = new values.constructor(vertices.length * width);
  for (let i = 0; i < vertices.length; ++i) {
    for (let k = 0; k < width; ++k) result[i * width + k] = values[vertices[i] * width + k];
  }
  return result;
}
