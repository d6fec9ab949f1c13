"""Reads the data of a page as docs/formats.md describes them, and PNG files, with Python alone: an
oracle for the page's own script and for the exporter."""

import base64
import json
import math
import re
import struct
import zlib


class Image:
    """Rows of 3 channels from the bottom, read bilinearly."""

    def __init__(self, width, height, texels):
        self.width, self.height, self.texels = width, height, texels

    def texel(self, x, y):
        x, y = min(max(x, 0), self.width - 1), min(max(y, 0), self.height - 1)
        at = 3 * (y * self.width + x)
        return self.texels[at:at + 3]

    def at(self, u, v):
        x, y = u * self.width - 0.5, v * self.height - 0.5
        x0, y0 = math.floor(x), math.floor(y)
        s, t = x - x0, y - y0
        a, b = self.texel(x0, y0), self.texel(x0 + 1, y0)
        c, d = self.texel(x0, y0 + 1), self.texel(x0 + 1, y0 + 1)
        return [(1 - t) * ((1 - s) * a[k] + s * b[k]) + t * ((1 - s) * c[k] + s * d[k])
                for k in range(3)]


def paeth(left, lower, corner):
    p = left + lower - corner
    a, b, c = abs(p - left), abs(p - lower), abs(p - corner)
    return left if a <= b and a <= c else lower if b <= c else corner


def read_png(data):
    """Reads an 8-bit RGB or RGBA file."""
    at, packed = 8, b''
    while at < len(data):
        size, kind = struct.unpack('>I4s', data[at:at + 8])
        if kind == b'IHDR':
            width, height, depth, colour = struct.unpack('>IIBB', data[at + 8:at + 18])
        if kind == b'IDAT':
            packed += data[at + 8:at + 8 + size]
        at += 12 + size
    channels = {2: 3, 6: 4}[colour]
    assert depth == 8
    raw, row, rows = zlib.decompress(packed), width * channels, []
    last = bytearray(row)
    for y in range(height):
        kind = raw[y * (row + 1)]
        line = bytearray(raw[y * (row + 1) + 1:(y + 1) * (row + 1)])
        for i in range(row):
            left = line[i - channels] if i >= channels else 0
            corner = last[i - channels] if i >= channels else 0
            guess = (0, left, last[i], (left + last[i]) // 2, paeth(left, last[i], corner))[kind]
            line[i] = (line[i] + guess) & 255
        rows.append(line)
        last = line
    if channels == 4:
        rows = [bytearray(b for i, b in enumerate(line) if i % 4 < 3) for line in rows]
    return Image(width, height, b''.join(bytes(line) for line in reversed(rows)))


def read_light(data):
    """Reads a page of light (exporters/html/light_page.h)."""
    raw = zlib.decompress(data)
    width, height, top = struct.unpack('<IIf', raw[:12])
    count = width * height

    def restored(differences, modulus):
        values = [0] * count
        for i in range(count):
            left = values[i - 1] if i % width else 0
            lower = values[i - width] if i >= width else 0
            corner = values[i - width - 1] if i % width and i >= width else 0
            values[i] = (differences[i] + paeth(left, lower, corner)) % modulus
        return values

    planes = [raw[12 + p * count:12 + (p + 1) * count] for p in range(4)]
    folded = [low + 256 * high for low, high in zip(planes[0], planes[1])]
    codes = restored([f // 2 if f % 2 == 0 else -(f // 2) - 1 for f in folded], 65536)
    red, blue = restored(planes[2], 256), restored(planes[3], 256)
    texels = []
    for code, r, b in zip(codes, red, blue):
        if code == 0:
            texels += [0, 0, 0]
            continue
        r, b = r / 255, b / 255
        g = max(0, 1 - r - b)
        total = 2 ** (top + (code - 65535) / 256) / (0.2126 * r + 0.7152 * g + 0.0722 * b)
        texels += [r * total, g * total, b * total]
    return Image(width, height, texels)


class PageFile:
    """`world` is the page's JSON; `triangles` has the page and three corners (position, uv, chart) of
    each triangle; `images` the pages."""

    def __init__(self, path):
        self.text = open(path, encoding='utf-8').read()
        self.world = json.loads(self._script('world'))
        self.triangles = list(self._triangles(zlib.decompress(self._data('mesh'))))
        self.images = []
        for i, page in enumerate(self.world['pages']):
            read = read_png if page['type'] == 'image/png' else read_light
            self.images.append(read(self._data(f'page{i}')))

    def _script(self, name):
        return re.search(rf'<script type="[^"]*" id="{name}">(.*?)</script>', self.text, re.S)[1]

    def _data(self, name):
        return base64.b64decode(self._script(name))

    def _triangles(self, data):
        at = 0

        def column(count):
            nonlocal at
            planes = data[at]
            at += 1
            values = [0] * count
            for p in range(planes):
                values = [v + (b << (8 * p)) for v, b in zip(values, data[at:at + count])]
                at += count
            return values

        def running(count):
            total, result = 0, []
            for v in column(count):
                total += v // 2 if v % 2 == 0 else -(v // 2) - 1
                result.append(total)
            return result

        mesh = self.world['mesh']
        for part in self.world['parts']:
            count = part['vertices']
            axes = [[mesh['low'][k] + mesh['step'] * v for v in running(count)] for k in range(3)]
            uvs = [[v / mesh['uvSteps'] for v in running(count)] for _ in range(2)]
            corners = list(zip(zip(*axes), zip(*uvs), running(count)))
            following, indices = 0, []
            for distance in column(3 * part['triangles']):
                indices.append(following - distance)
                following = max(following, indices[-1] + 1)
            for k in range(0, len(indices), 3):
                yield part['page'], [corners[i] for i in indices[k:k + 3]]
        assert at == len(data)
