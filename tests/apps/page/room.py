"""Writes the scene of the test: a room with a block and stairs in it, lit by one lamp. Vertices carry
the illuminance in lx."""

import math

LAMP, POWER, FLOOR_OF_LIGHT = (1.9, 1.7, 2.9), 900.0, 40.0
WALLS, BLOCK, STEPS = (0.75, 0.72, 0.68), (0.6, 0.2, 0.15), (0.4, 0.42, 0.5)
SIZE = (4.0, 2.8, 5.0)


def illuminance(p, normal):
    way = [l - x for l, x in zip(LAMP, p)]
    d = math.sqrt(sum(x * x for x in way))
    cosine = sum(x * n for x, n in zip(way, normal)) / d
    return FLOOR_OF_LIGHT + POWER * max(0.0, cosine) / (d * d)


def faces():
    """Yields corner, two sides and material of each rectangle; its front is on the side of their cross
    product."""
    def box(low, high, material, inward):
        (x, y, z), (a, b, c) = low, [h - l for h, l in zip(high, low)]
        for corner, u, v in [((x, y, z), (a, 0, 0), (0, 0, c)), ((x, y + b, z), (0, 0, c), (a, 0, 0)),
                             ((x, y, z), (0, b, 0), (a, 0, 0)), ((x, y, z + c), (a, 0, 0), (0, b, 0)),
                             ((x, y, z), (0, 0, c), (0, b, 0)), ((x + a, y, z), (0, b, 0), (0, 0, c))]:
            yield (corner, v, u, material) if inward else (corner, u, v, material)

    yield from box((0, 0, 0), SIZE, 'walls', True)
    yield from box((1.2, 0, 1.0), (2.2, 0.9, 1.8), 'block', False)
    for i in range(4):
        yield from box((3.0, 0, 1.0 + 0.35 * i), (4.0, 0.18 * (i + 1), 1.35 + 0.35 * i), 'steps', False)


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def steps(u, v):
    """Returns how many squares a face has along its sides."""
    return [max(1, math.ceil(math.sqrt(sum(x * x for x in side)) / 0.125)) for side in (u, v)]


def interpolated(place, corner, u, v, normal):
    """Returns what the triangles of a face hold at a place, for either diagonal of their squares."""
    d = [x - c for x, c in zip(place, corner)]
    counts = steps(u, v)
    cells, rests = [], []
    for side, count in zip((u, v), counts):
        at = count * sum(x * y for x, y in zip(d, side)) / sum(y * y for y in side)
        cells.append(min(max(int(at), 0), count - 1))
        rests.append(at - cells[-1])
    light = lambda i, j: illuminance([c + (cells[0] + i) / counts[0] * a + (cells[1] + j) / counts[1] * b
                                      for c, a, b in zip(corner, u, v)], normal)
    (s, t), p, q, r, w = rests, light(0, 0), light(1, 0), light(1, 1), light(0, 1)
    one = (1 - s) * p + (s - t) * q + t * r if s > t else (1 - t) * p + (t - s) * w + s * r
    other = (1 - s - t) * p + s * q + t * w if s + t < 1 else (s + t - 1) * r + (1 - t) * q + (1 - s) * w
    return one, other


def write(folder):
    """Writes room.obj and room.mtl. Returns the path."""
    vertices, lines = [], ['mtllib room.mtl']
    for corner, u, v, material in faces():
        normal = cross(u, v)
        size = math.sqrt(sum(x * x for x in normal))
        normal = [x / size for x in normal]
        counts = steps(u, v)
        first = len(vertices) + 1
        for j in range(counts[1] + 1):
            for i in range(counts[0] + 1):
                p = [c + i / counts[0] * a + j / counts[1] * b for c, a, b in zip(corner, u, v)]
                vertices.append((p, illuminance(p, normal)))
        lines.append(f'usemtl {material}')
        row = counts[0] + 1
        for j in range(counts[1]):
            for i in range(counts[0]):
                k = first + j * row + i
                lines.append(f'f {k} {k + 1} {k + row + 1} {k + row}')
    with open(folder / 'room.obj', 'w') as file:
        for p, light in vertices:
            file.write('v ' + ' '.join(f'{x:.6f}' for x in [*p, light, light, light]) + '\n')
        file.write('\n'.join(lines) + '\n')
    with open(folder / 'room.mtl', 'w') as file:
        for name, colour in [('walls', WALLS), ('block', BLOCK), ('steps', STEPS)]:
            file.write(f'newmtl {name}\nKd {colour[0]} {colour[1]} {colour[2]}\n')
    return folder / 'room.obj'
