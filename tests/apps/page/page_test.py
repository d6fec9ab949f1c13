"""Exports a room as a page of HTML, checks the file, and drives it in a headless Chromium.
Usage: page_test.py PATH/TO/atlas-export. Ends with 77 (skipped) where there is no browser."""

import json
import math
import pathlib
import random
import re
import subprocess
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True  # the sources stay as they are
import browser
import page_file
import room

EXPORT = sys.argv[1]
POINTS = 1000

PNG = ('--texture-format', 'png')


def export(folder, *options):
    target = folder / f'room{len(options)}.html'
    subprocess.run([EXPORT, room.write(folder), '-o', target, '--atlases', '1', '--atlas-size', '256',
                    '--report', folder / 'report.json', '-q', *options], check=True)
    return target


def luma(c):
    return 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2]


def points_of(file, count):
    """Yields points spread over the file's triangles by area: place, normal, page and uv."""
    rng = random.Random(1)
    normals = []
    for _, corners in file.triangles:
        a, b, c = (corner[0] for corner in corners)
        normals.append(room.cross([x - y for x, y in zip(b, a)], [x - y for x, y in zip(c, a)]))
    areas = [math.dist((0, 0, 0), normal) for normal in normals]
    for i in rng.choices(range(len(areas)), areas, k=count):
        page, corners = file.triangles[i]
        r, s = math.sqrt(rng.random()), rng.random()
        w = (1 - r, r * (1 - s), r * s)
        mix = lambda which: [sum(w[i] * corners[i][which][k] for i in range(3))
                             for k in range(len(corners[0][which]))]
        yield mix(0), normals[i], page, mix(1)


def light_of(place, front):
    """Returns the room's illuminance and reflectance at a place on the face with this front, and what
    a mesh may have there whose squares are cut along either diagonal."""
    best = None
    for corner, u, v, material in room.faces():
        normal = room.cross(u, v)
        size = math.dist((0, 0, 0), normal)
        normal = [x / size for x in normal]
        d = [x - c for x, c in zip(place, corner)]
        off = abs(sum(x * n for x, n in zip(d, normal)))
        within = all(-1e-3 <= sum(x * y for x, y in zip(d, side)) / sum(y * y for y in side) <= 1.001
                     for side in (u, v))
        agrees = sum(x * n for x, n in zip(front, normal)) > 0
        if within and agrees and (best is None or off < best[0]):
            best = (off, room.illuminance(place, normal), getattr(room, material.upper()),
                    room.interpolated(place, corner, u, v, normal))
    return best[1:]


class TheFile(unittest.TestCase):
    """Without a browser."""

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.path = pathlib.Path(cls.folder.name)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def test_pages_show_the_light(self):
        file = page_file.PageFile(export(self.path, *PNG))
        white = json.load(open(self.path / 'report.json'))['light']['white']
        square = 0
        for place, front, page, uv in points_of(file, POINTS):
            light, reflectance, _ = light_of(place, front)
            want = [encode(min(1, light * r / white)) for r in reflectance]
            got = file.images[page].at(*uv)
            square += sum((w - g / 255) ** 2 for w, g in zip(want, got)) / 3
        self.assertGreater(-10 * math.log10(square / POINTS), 40)
        self.assertEqual(list(self.path.glob('*.png')), [])  # they are in the page

    def test_a_scan_becomes_a_page_as_the_documents_say(self):
        text = (pathlib.Path(__file__).parents[3] / 'docs/formats.md').read_text()
        command = re.search(r'^build/apps/atlas-export/atlas-export (scan.ply .*)$', text, re.M)[1]
        grey, corners = (40, 130, 220), ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0))
        with open(self.path / 'scan.ply', 'w') as ply:
            ply.write('ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n'
                      'property float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n'
                      'element face 2\nproperty list uchar int vertex_indices\nend_header\n')
            ply.write(''.join(f'{x} {y} {z} {grey[0]} {grey[1]} {grey[2]}\n' for x, y, z in corners))
            ply.write('3 0 1 2\n3 0 2 3\n')
        subprocess.run([EXPORT, *command.split(), *PNG, '-q'], cwd=self.path, check=True)
        file = page_file.PageFile(self.path / 'scan.html')
        for _, _, page, uv in points_of(file, 50):
            for got, want in zip(file.images[page].at(*uv), grey):
                self.assertLess(abs(got - want), 1.5)

    def test_pages_of_light_hold_it(self):
        file = page_file.PageFile(export(self.path, '--linear'))
        report = json.load(open(self.path / 'report.json'))
        white = report['light']['white']
        shown = lambda colour: encode(min(1, luma(colour) / white))
        errors, reported = [], []
        for place, front, page, uv in points_of(file, POINTS):
            light, reflectance, inputs = light_of(place, front)
            got = file.images[page].at(*uv)
            errors.append(abs(luma(got) / luma([light * r for r in reflectance]) - 1))
            reported.append(min(abs(shown(got) - shown([i * r for r in reflectance])) for i in inputs))
        errors.sort()
        reported.sort()
        self.assertLess(errors[int(0.95 * POINTS)], 0.03)
        # The luminance is as near the input's as the report says, and the step of its code.
        error = report['error']
        self.assertLess(reported[int(0.95 * POINTS)], 1.2 * error['p95'] + 0.0005)
        self.assertLess(reported[-1], 1.2 * error['max'] + 0.0005)
        self.assertEqual(list(self.path.glob('*.light')), [])


def encode(v):
    return 12.92 * v if v <= 0.0031308 else 1.055 * v ** (1 / 2.4) - 0.055


class InTheBrowser(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        path = pathlib.Path(cls.folder.name)
        cls.webp, cls.plain, cls.linear = export(path), export(path, *PNG), export(path, '--linear')
        cls.page = browser.Browser()

    @classmethod
    def tearDownClass(cls):
        cls.page.close()
        cls.folder.cleanup()

    def open(self, path, **window):
        seconds = self.page.open(path, **window)
        self.page.settle()
        return seconds

    def expect_silence(self, path):
        """Nothing on the console, and nothing loaded but the file and what it made itself."""
        self.assertEqual(self.page.log, [])
        others = [r for r in self.page.requests if not r.startswith('blob:')]
        self.assertEqual(others, ['file://' + str(path)])

    def picked(self, x, y):
        return self.page.value(f'libatlas.pick({x}, {y})')

    def test_shows_what_the_pages_hold(self):
        self.open(self.plain)
        file = page_file.PageFile(self.plain)
        shot = page_file.read_png(self.page.screenshot())
        rng = random.Random(2)
        compared = 0
        while compared < 60:
            x, y = rng.randrange(10, 1270), rng.randrange(70, 730)
            hit = self.picked(x + 0.5, y + 0.5)
            near = [self.picked(x + 0.5 + dx, y + 0.5 + dy) for dx, dy in ((-2, 0), (2, 0), (0, 2), (0, -2))]
            if any(n is None or n['chart'] != hit['chart'] for n in near):
                continue  # at an edge
            want = file.images[hit['page']].at(hit['u'], hit['v'])
            got = shot.texel(x, shot.height - 1 - y)
            for w, g in zip(want, got):
                self.assertLess(abs(w - g), 4, (x, y, want, list(got)))
            compared += 1
        self.expect_silence(self.plain)

    def test_webp_looks_the_same(self):
        self.assertIn('"image/webp"', self.webp.read_text())
        self.assertLess(self.webp.stat().st_size, self.plain.stat().st_size)
        pictures = []
        for path in (self.webp, self.plain):
            self.open(path, width=640, height=400)
            self.page.value("document.getElementById('hint').hidden = true")
            pictures.append(page_file.read_png(self.page.screenshot()).texels)
            self.expect_silence(path)
        square = sum((a - b) ** 2 for a, b in zip(*pictures)) / len(pictures[0])
        self.assertGreater(10 * math.log10(255 ** 2 / square), 38)

    def test_values_are_those_of_the_pages(self):
        self.open(self.linear)
        file = page_file.PageFile(self.linear)
        # The very places of the file.
        points = [[page, *uv] for _, _, page, uv in points_of(file, POINTS)]
        values = self.page.value(f'{json.dumps(points)}.map((p) => libatlas.valueAt(...p))')
        for (page, u, v), got in zip(points, values):
            want = file.images[page].at(u, v)
            self.assertLess(abs(luma(got) / luma(want) - 1), 0.001)
        # What lies under the pointer, in lx.
        rng = random.Random(3)
        places = [[rng.uniform(0, 1280), rng.uniform(0, 800)] for _ in range(POINTS)]
        hits = self.page.value(f'{json.dumps(places)}.map((p) => libatlas.pick(...p))')
        off = []
        for hit in hits:
            image = file.images[hit['page']].at(hit['u'], hit['v'])
            light, reflectance, _ = light_of(hit['position'], hit['normal'])
            want = luma([c / r for c, r in zip(image, reflectance)])
            self.assertLess(abs(hit['value'] / want - 1), 0.02)
            off.append(abs(hit['value'] / light - 1))
        self.assertLess(sorted(off)[int(0.95 * POINTS)], 0.03)
        self.expect_silence(self.linear)

    def test_offers_the_views_of_the_file(self):
        folder = pathlib.Path(self.folder.name) / 'views'
        folder.mkdir()
        world = folder / 'views.wrl'
        subprocess.run([EXPORT, room.write(folder), '-o', world, '--charts-only', '-q'], check=True)
        with open(world, 'a') as file:
            file.write('Viewpoint { position 1 1.2 4 orientation 0 1 0 1.5707963 description "Corner" }\n'
                       'Viewpoint { position 2 1.6 3 }\n')
        target = folder / 'views.html'
        subprocess.run([EXPORT, world, '-o', target, '-q'], check=True)
        self.open(target)
        places = self.page.value("[...document.querySelectorAll('#places option')].map((o) => o.text)")
        self.assertEqual(places[2:4], ['Corner', 'Viewpoint 3'])
        self.page.value("document.getElementById('places').value = '1'; "
                        "document.getElementById('places').dispatchEvent(new Event('change'))")
        eye, ahead = self.page.value('[libatlas.viewer.motion.eye, libatlas.viewer.motion.ahead()]')
        for got, want in zip(eye + ahead, (1, 1.2, 4, -1, 0, 0)):
            self.assertAlmostEqual(got, want, delta=1e-3)
        self.expect_silence(target)

    def test_exposure_and_false_colours_change_the_picture(self):
        self.open(self.linear)
        pictures = [self.page.screenshot()]
        for command in ("show('light'); libatlas.viewer.expose(1)", "show('falseColours')", "show('charts')",
                        "show('pages')", "show('error')"):
            self.page.value(f'libatlas.viewer.{command}')
            self.page.settle()
            pictures.append(self.page.screenshot())
        texel = [page_file.read_png(p).texel(640, 400) for p in pictures]
        # One stop doubles the light.
        decode = lambda v: ((v / 255 + 0.055) / 1.055) ** 2.4
        self.assertAlmostEqual(decode(texel[1][1]) / decode(texel[0][1]), 2, delta=0.15)
        self.assertEqual(len(set(bytes(t) for t in texel)), len(texel))
        self.expect_silence(self.linear)

    def test_measures_a_rectangle(self):
        self.open(self.linear)
        self.page.value("libatlas.viewer.show('falseColours')")
        # On the floor, looking straight down from where people stand.
        self.page.value('libatlas.viewer.setMode("fly"); libatlas.viewer.motion.setView([3, 1.7, 4], [0, -1, -0.05])')
        self.page.value('libatlas.viewer.measuring.active = true; libatlas.viewer.refresh()')
        self.page.settle()
        for kind, x, y in (('Moved', 400, 250), ('Pressed', 400, 250), ('Moved', 500, 400), ('Moved', 640, 520),
                           ('Released', 640, 520)):
            self.page.mouse(kind, x, y, held=kind != 'Released' and (x, y, kind) != (400, 250, 'Moved'))
        result = self.page.value('libatlas.viewer.measuring.result')
        self.assertIsNotNone(result)
        corner, u, v = (self.page.value(f'libatlas.viewer.measuring.rectangle.{k}') for k in ('corner', 'u', 'v'))
        longer, shorter = sorted(result['sides'], reverse=True)
        d = shorter if longer >= 2 * shorter else longer
        self.assertAlmostEqual(result['spacing'], 0.2 * 5 ** math.log10(d), places=6)
        counts = [max(2, math.ceil(s / result['spacing'])) for s in result['sides']]
        self.assertEqual(result['points'], counts[0] * counts[1])
        light = [room.illuminance([c + (i + 0.5) / counts[0] * a + (j + 0.5) / counts[1] * b
                                   for c, a, b in zip(corner, u, v)], (0, 1, 0))
                 for i in range(counts[0]) for j in range(counts[1])]
        mean = sum(light) / len(light)
        self.assertAlmostEqual(result['mean'] / mean, 1, delta=0.02)
        self.assertAlmostEqual(result['least'] / min(light), 1, delta=0.03)
        self.expect_silence(self.linear)

    def walk(self, eye, direction, seconds):
        """Walks ahead in steps of a 60th of a second. Returns the eye and the highest it was."""
        return self.page.value(f'''(() => {{
          const m = libatlas.viewer.motion;
          m.setMode('walk');
          m.setView({eye}, {direction});
          m.move.ahead = 1;
          let top = 0;
          for (let t = 0; t < {seconds}; t += 1 / 60) {{ m.advance(1 / 60); top = Math.max(top, m.eye[1]); }}
          m.move.ahead = 0;
          return [m.eye, top];
        }})()''')

    def test_walks_on_the_floor_and_not_through_walls(self):
        self.open(self.plain)
        height = self.page.value('libatlas.viewer.motion.height')
        radius = self.page.value('libatlas.viewer.motion.radius')
        eye, top = self.walk([0.8, 1.6, 4.2], [0, 0, -1], 6)
        self.assertAlmostEqual(eye[2], radius, places=3)
        self.assertAlmostEqual(eye[1], height, delta=0.01)
        eye, top = self.walk([1.7, height, 3.5], [0, 0, -1], 4)  # against the block
        self.assertAlmostEqual(eye[2], 1.8 + radius, places=2)
        eye, top = self.walk([3.5, height, 0.5], [0, 0, 1], 5)  # up the stairs and down behind them
        self.assertAlmostEqual(top, height + 4 * 0.18, delta=0.02)
        self.assertAlmostEqual(eye[1], height, delta=0.01)
        self.assertAlmostEqual(eye[2], room.SIZE[2] - radius, places=2)
        self.expect_silence(self.plain)

    def test_keys_alone_reach_everything(self):
        self.open(self.linear)
        self.page.value("libatlas.viewer.show('falseColours')")
        reached = set()
        for _ in range(16):
            self.page.key('Tab')
            reached.add(self.page.value(
                '((e) => e.id || e.name || e.type || e.tagName)(document.activeElement)'))
        self.assertLessEqual({'view', 'mode', 'views', 'places', 'shot', 'keys', 'number', 'checkbox',
                              'select-one', 'button'}, reached)
        self.page.value("document.getElementById('view').focus()")
        self.page.key('?', 'Slash', '?')
        self.assertTrue(self.page.value("document.getElementById('help').open"))
        self.page.key('Escape')
        self.assertFalse(self.page.value("document.getElementById('help').open"))
        self.page.value("libatlas.viewer.setMode('walk'); libatlas.viewer.motion.setView([0.8, 1.6, 4], [0, 0, -1])")
        self.page.press('w', 'KeyW')
        self.page.value('''new Promise((done) => { const wait = () => libatlas.viewer.motion.eye[2] < 3.9
          ? done() : setTimeout(wait, 20); wait(); })''')
        self.page.release('w', 'KeyW')
        self.page.key('3', 'Digit3', '3')
        self.assertEqual(self.page.value('libatlas.viewer.motion.mode'), 'orbit')
        self.expect_silence(self.linear)

    def test_fits_a_phone(self):
        self.open(self.linear, width=390, height=844, phone=True)
        for view in ('light', 'falseColours', 'pages'):
            self.page.value(f"libatlas.viewer.show('{view}')")
            outside = self.page.value('''[...document.querySelectorAll('header, h1, #menu, #panel, #panel *')]
              .filter((e) => { const b = e.getBoundingClientRect();
                return b.width && (b.left < 0 || b.right > innerWidth + 0.5); }).map((e) => e.outerHTML)''')
            self.assertEqual(outside, [])
        self.page.value("document.getElementById('menu').click()")
        small = self.page.value('''[...document.querySelectorAll('#menu, #tools button, #tools select')]
          .filter((e) => e.getBoundingClientRect().height < 44).map((e) => e.id)''')
        self.assertEqual(small, [])
        self.expect_silence(self.linear)


if __name__ == '__main__':
    lacks = browser.missing()
    suite = unittest.defaultTestLoader.loadTestsFromTestCase(TheFile)
    if not lacks:
        suite.addTests(unittest.defaultTestLoader.loadTestsFromTestCase(InTheBrowser))
    result = unittest.TextTestRunner(verbosity=2).run(suite)
    if not result.wasSuccessful():
        sys.exit(1)
    if lacks:
        print(f'the page was not opened in a browser: {lacks}')
        sys.exit(77)
