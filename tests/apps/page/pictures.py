"""Draws the documents' pictures of pages of HTML.
Usage: pictures.py PATH/TO/atlas-export cabin.obj FOLDER, with a cabin of 100 000 triangles by
atlas-make-cabin. Writes page.png and page_phone.png, of the cabin, and page_false_colours.png, of the
tests' room."""

import pathlib
import subprocess
import sys
import tempfile

sys.dont_write_bytecode = True  # the sources stay as they are
import browser
import room


def export(program, scene, target, *options):
    subprocess.run([program, scene, '-o', target, '-q', *options], check=True)
    return target


def measure_floor(page):
    """Draws a rectangle on the floor before the block, and leaves the pointer in it."""
    page.value("libatlas.viewer.show('falseColours')")
    page.value("libatlas.viewer.motion.setView([0.35, 1.6, 4.7], [0.62, -0.28, -1])")
    page.value('libatlas.viewer.measuring.active = true; libatlas.viewer.refresh()')
    page.settle()
    corners = (330, 640), (640, 640)
    page.mouse('Moved', *corners[0], held=False)
    page.mouse('Pressed', *corners[0])
    page.mouse('Moved', 500, 650)
    page.mouse('Moved', *corners[1])
    page.mouse('Released', *corners[1])
    page.mouse('Moved', 480, 660, held=False)


def main(program, cabin, folder):
    folder = pathlib.Path(folder)
    with tempfile.TemporaryDirectory() as temporary, browser.Browser() as page:
        path = pathlib.Path(temporary)
        world = export(program, cabin, path / 'cabin.html', '--up', 'z')
        for name, size, phone in (('page', (1280, 800), False), ('page_phone', (390, 844), True)):
            page.open(world, *size, phone=phone)
            page.settle()
            (folder / f'{name}.png').write_bytes(page.screenshot())
        light = export(program, room.write(path), path / 'room.html', '--linear', '--atlases', '1',
                       '--atlas-size', '1024')
        page.open(light)
        measure_floor(page)
        page.settle()
        (folder / 'page_false_colours.png').write_bytes(page.screenshot())


if __name__ == '__main__':
    main(*sys.argv[1:])
