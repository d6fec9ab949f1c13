"""Writes a scene whose nodes show one mesh, a house with a checkered texture, at several places and
sizes."""

import json
import math
import struct
import zlib

PLACES = [(0, 1, 0), (2.5, 1, 30), (5, 0.7, 80), (7.5, 1.3, 200), (1.2, 0.8, 300), (3.8, 1, 140)]
COLOURS = [(208, 80, 48), (48, 96, 208)]


def checker():
    rows = b''.join(b'\0' + b''.join(bytes(COLOURS[(x + y) % 2]) for x in range(8))
                    for y in range(8))
    chunk = lambda kind, data: struct.pack('>I', len(data)) + kind + data + struct.pack(
        '>I', zlib.crc32(kind + data))
    header = struct.pack('>IIBBBBB', 8, 8, 8, 2, 0, 0, 0)
    return b'\x89PNG\r\n\x1a\n' + chunk(b'IHDR', header) + chunk(b'IDAT', zlib.compress(rows)) + chunk(b'IEND', b'')


def house():
    """Returns positions, uvs and triangles: four walls, each of 4 x 4 squares, and two slopes."""
    positions, uvs, triangles = [], [], []

    def patch(corner, u, v):
        first = len(positions)
        for j in range(5):
            for i in range(5):
                positions.append([c + i / 4 * a + j / 4 * b for c, a, b in zip(corner, u, v)])
                uvs.append([i / 4, j / 4])
        for j in range(4):
            for i in range(4):
                a = first + 5 * j + i
                triangles.extend([a, a + 1, a + 6, a, a + 6, a + 5])

    patch((0, 0, 1), (1, 0, 0), (0, 1, 0))
    patch((1, 0, 1), (0, 0, -1), (0, 1, 0))
    patch((1, 0, 0), (-1, 0, 0), (0, 1, 0))
    patch((0, 0, 0), (0, 0, 1), (0, 1, 0))
    patch((0, 1, 1), (1, 0, 0), (0, 0.5, -0.5))
    patch((1, 1, 0), (-1, 0, 0), (0, 0.5, 0.5))
    return positions, uvs, triangles


def write(path):
    positions, uvs, triangles = house()
    image = checker()
    parts = [struct.pack(f'<{3 * len(positions)}f', *sum(positions, [])),
             struct.pack(f'<{2 * len(uvs)}f', *sum(uvs, [])),
             struct.pack(f'<{len(triangles)}H', *triangles), image]
    views, binary = [], b''
    for part in parts:
        views.append({'buffer': 0, 'byteOffset': len(binary), 'byteLength': len(part)})
        binary += part + b'\0' * (-len(part) % 4)
    column = lambda i: [p[i] for p in positions]
    nodes = [{'mesh': 0, 'translation': [x, 0, 0], 'scale': [size] * 3,
              'rotation': [0, math.sin(math.radians(turn) / 2), 0, math.cos(math.radians(turn) / 2)]}
             for x, size, turn in PLACES]
    scene = {
        'asset': {'version': '2.0'}, 'scene': 0, 'scenes': [{'nodes': list(range(len(nodes)))}],
        'nodes': nodes, 'buffers': [{'byteLength': len(binary)}], 'bufferViews': views,
        'accessors': [
            {'bufferView': 0, 'componentType': 5126, 'type': 'VEC3', 'count': len(positions),
             'min': [min(column(i)) for i in range(3)], 'max': [max(column(i)) for i in range(3)]},
            {'bufferView': 1, 'componentType': 5126, 'type': 'VEC2', 'count': len(uvs)},
            {'bufferView': 2, 'componentType': 5123, 'type': 'SCALAR', 'count': len(triangles)}],
        'meshes': [{'primitives': [{'attributes': {'POSITION': 0, 'TEXCOORD_0': 1}, 'indices': 2,
                                    'material': 0}]}],
        'materials': [{'pbrMetallicRoughness': {'baseColorTexture': {'index': 0}}, 'doubleSided': True,
                       'extensions': {'KHR_materials_unlit': {}}}],
        'extensionsUsed': ['KHR_materials_unlit'],
        'textures': [{'source': 0, 'sampler': 0}], 'samplers': [{'magFilter': 9728, 'minFilter': 9728}],
        'images': [{'bufferView': 3, 'mimeType': 'image/png'}]}
    text = json.dumps(scene).encode()
    text += b' ' * (-len(text) % 4)
    path.write_bytes(struct.pack('<4sII', b'glTF', 2, 28 + len(text) + len(binary)) +
                     struct.pack('<I4s', len(text), b'JSON') + text +
                     struct.pack('<I4s', len(binary), b'BIN\0') + binary)
    return path
