"""Loads what the exporter writes for viewers of glTF with three.js, in a headless Chromium, and compares
the pictures with the one that the page of HTML shows from the same place, or with those of the input.
Usage: three_test.py PATH/TO/atlas-export FOLDER, where FOLDER keeps the installed packages. Ends with 77
(skipped) where there is no browser or npm cannot install three.js."""

import collections
import functools
import http.server
import json
import math
import pathlib
import shutil
import subprocess
import sys
import tempfile
import threading
import unittest
import urllib.parse

sys.dont_write_bytecode = True  # the sources stay as they are
import browser
import instances
import page_file
import room

EXPORT, KEPT = sys.argv[1], pathlib.Path(sys.argv[2])
HERE = pathlib.Path(__file__).parents[2] / 'support/gltf_viewers'
# PNG and lossless and lossy WebP, each with and without compression of the mesh.
WEIGHTS = [(*pages, *mesh) for pages in (('--texture-format', 'png'), ('--texture-format', 'webp'),
                                         ('--texture-format', 'webp', '--quality', '90'))
           for mesh in ((), ('--compress',))]
SIZE = {'width': 640, 'height': 400}


def install():
    """Installs three.js and Khronos' validator as their lock file says, once. Returns what is lacking, or None."""
    if shutil.which('npm') is None:
        return 'there is no npm'
    KEPT.mkdir(parents=True, exist_ok=True)
    lock = HERE / 'package-lock.json'
    installed = KEPT / 'package-lock.json'
    if installed.exists() and installed.read_bytes() == lock.read_bytes():
        return None
    for name in ('package.json', 'package-lock.json', 'validate.cjs'):
        shutil.copy(HERE / name, KEPT)
    result = subprocess.run(['npm', 'ci', '--ignore-scripts'], cwd=KEPT, capture_output=True, text=True)
    if result.returncode != 0:
        installed.unlink()
        return 'npm cannot install three.js: ' + result.stderr[-300:]
    return None


class Handler(http.server.SimpleHTTPRequestHandler):
    def log_message(self, *_):
        pass


def serve(folder):
    server = http.server.ThreadingHTTPServer(('127.0.0.1', 0), functools.partial(Handler, directory=folder))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    return server


def decibels(a, b):
    square = sum((x - y) ** 2 for x, y in zip(a, b)) / len(a)
    return 10 * math.log10(255 ** 2 / square) if square else math.inf


class Three(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.path = pathlib.Path(cls.folder.name)
        shutil.copy(HERE / 'three.html', cls.path)
        (cls.path / 'three').symlink_to(KEPT / 'node_modules' / 'three')
        cls.scene = room.write(cls.path)
        cls.server = serve(cls.path)
        cls.page = browser.Browser()

    @classmethod
    def tearDownClass(cls):
        cls.page.close()
        cls.server.shutdown()
        cls.folder.cleanup()

    def export(self, name, *options, scene=None):
        target = self.path / name
        subprocess.run([EXPORT, scene or self.scene, '-o', target, '--atlases', '1', '--atlas-size', '512',
                        '-q', *options], check=True)
        return target

    def shown_by_three(self, name, view, **more):
        """Returns the texels of the picture, and how many triangles were loaded."""
        query = urllib.parse.urlencode({'file': name, **{k: json.dumps(v) for k, v in view.items()}, **more})
        self.page.load(f'http://127.0.0.1:{self.server.server_address[1]}/three.html?{query}', **SIZE)
        self.page.wait_for('window.shown')
        triangles = self.page.value('window.shown')
        self.assertEqual([line for line in self.page.log if '"level": "error"' in line or
                          'exceptionDetails' in line], [])
        return page_file.read_png(self.page.screenshot()).texels, triangles

    def shown_by_the_page(self, *options):
        self.page.open(self.export('room.html', '--texture-format', 'png', *options), **SIZE)
        self.page.value("document.querySelectorAll('body > :not(canvas):not(#view)')"
                        ".forEach((e) => e.style.visibility = 'hidden')")
        self.page.settle()
        motion = 'libatlas.viewer.motion'
        view = {'eye': self.page.value(f'{motion}.eye'), 'ahead': self.page.value(f'{motion}.ahead()'),
                'fov': self.page.value(f'{motion}.fov')}
        return page_file.read_png(self.page.screenshot()).texels, view

    def test_worlds_look_as_in_the_page(self):
        page, view = self.shown_by_the_page()
        counts = set()
        for weight in WEIGHTS:
            name = ''.join(weight[1:]) + '.glb'
            self.export(name, *weight)
            picture, triangles = self.shown_by_three(name, view)
            counts.add(triangles)
            print(f'{name}: {triangles:.0f} triangles, {decibels(picture, page):.1f} dB beside the page')
            self.assertGreater(decibels(picture, page), 35)
        self.assertEqual(len(counts), 1)

    def test_kept_scenes_look_as_in_the_page(self):
        white = '--white', '1500'  # a lightmap holds no light above it, whatever the reflectance
        page, view = self.shown_by_the_page(*white)
        for weight in WEIGHTS:
            name = 'kept_' + ''.join(weight[1:]) + '.glb'
            self.export(name, '--keep-scene', *weight, *white)
            picture, triangles = self.shown_by_three(name, view)
            print(f'{name}: {triangles:.0f} triangles, {decibels(picture, page):.1f} dB beside the page')
            self.assertGreater(decibels(picture, page), 35)

    def test_instances_are_drawn_as_in_the_input(self):
        view = {'eye': [3.5, 4, 9], 'ahead': [0, -0.35, -1], 'fov': 0.8}
        scene = instances.write(self.path / 'instances.glb')
        want, _ = self.shown_by_three(scene.name, view)
        colours = collections.Counter(zip(want[0::3], want[1::3], want[2::3]))
        self.assertGreater(min(colours[c] for c in instances.COLOURS), 0.03 * len(want) / 3)
        for options in ((), ('--instances', 'extras'), ('--each',)):
            name = f'kept{"".join(options)}.glb'
            target = self.export(name, '--keep-scene', '--charts-only', *options, scene=scene)
            said = subprocess.run(['node', KEPT / 'validate.cjs', target], capture_output=True, text=True)
            self.assertEqual(said.stdout, f'{target}: valid\n')
            picture, _ = self.shown_by_three(name, view)
            print(f'{name}: {decibels(picture, want):.1f} dB beside the input')
            self.assertGreater(decibels(picture, want), 50)
            if '--each' not in options:
                self.expect_places_of_their_own(name, view)

    def expect_places_of_their_own(self, name, view):
        """No part of the page is shown by two of the meshes."""
        picture, _ = self.shown_by_three(name, view, places='1')
        owners = {}
        for r, g, b in zip(picture[0::3], picture[1::3], picture[2::3]):
            if b:
                owners.setdefault((r, g), set()).add(b)
        self.assertEqual(len(set().union(*owners.values())), len(instances.PLACES))
        shared = sum(len(numbers) > 1 for numbers in owners.values())
        print(f'{name}: {shared} of {len(owners)} places on the page are shown twice')
        self.assertLess(shared, 0.02 * len(owners))  # the pages of 512 texels are seen in steps of two


if __name__ == '__main__':
    lacks = browser.missing() or install()
    if lacks:
        print(f'three.js was not tried: {lacks}')
        sys.exit(77)
    unittest.main(argv=sys.argv[:1], verbosity=2)
