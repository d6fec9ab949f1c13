"""Drives a headless Chromium over the DevTools protocol."""

import base64
import json
import os
import shutil
import subprocess
import tempfile
import time
import urllib.request

try:
    import websocket  # Debian's python3-websocket
except ImportError:
    websocket = None

NAMES = ('chromium', 'chromium-browser', 'google-chrome')


def missing():
    """Says what a test lacks, or returns None."""
    if websocket is None:
        return 'python3-websocket is not installed'
    if not any(shutil.which(name) for name in NAMES):
        return 'there is no chromium'
    return None


class Browser:
    """One page of a browser with a profile of its own. `log` collects what is written to its console,
    `requests` what it loads."""

    def __init__(self):
        self.log, self.requests, self.number = [], [], 0
        self.folder = tempfile.mkdtemp(prefix='atlas-page-')
        program = next(filter(None, map(shutil.which, NAMES)))
        self.process = subprocess.Popen(
            [program, '--headless=new', '--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader',
             '--enable-unsafe-swiftshader', '--no-first-run', '--disable-dev-shm-usage',
             '--disable-background-networking', '--remote-allow-origins=*', '--remote-debugging-port=0',
             f'--user-data-dir={self.folder}', 'about:blank'],
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        try:
            self.socket = websocket.create_connection(self._address(), timeout=120)
            for domain in ('Runtime', 'Log', 'Network', 'Page'):
                self.call(domain + '.enable')
        except BaseException:
            self.close()
            raise

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def close(self):
        self.process.terminate()
        self.process.wait()
        shutil.rmtree(self.folder, ignore_errors=True)

    def _address(self):
        path = os.path.join(self.folder, 'DevToolsActivePort')
        end = time.time() + 60
        while time.time() < end:
            if os.path.exists(path):
                with open(path) as file:
                    lines = file.read().split()
                if len(lines) >= 2:
                    with urllib.request.urlopen(f'http://127.0.0.1:{lines[0]}/json') as answer:
                        for target in json.load(answer):
                            if target['type'] == 'page':
                                return target['webSocketDebuggerUrl']
            time.sleep(0.05)
        raise RuntimeError('chromium did not start within a minute')

    def call(self, method, **parameters):
        self.number += 1
        self.socket.send(json.dumps({'id': self.number, 'method': method, 'params': parameters}))
        while True:
            message = json.loads(self.socket.recv())
            self._note(message)
            if message.get('id') == self.number:
                if 'error' in message:
                    raise RuntimeError(f'{method}: {message["error"]}')
                return message['result']

    def _note(self, message):
        method = message.get('method', '')
        if method in ('Runtime.consoleAPICalled', 'Runtime.exceptionThrown', 'Log.entryAdded'):
            self.log.append(json.dumps(message['params'])[:1000])
        if method == 'Network.requestWillBeSent':
            self.requests.append(message['params']['request']['url'])

    def load(self, url, width=1280, height=800, phone=False):
        """Begins to load a page."""
        self.log.clear()
        self.requests.clear()
        self.call('Emulation.setDeviceMetricsOverride', width=width, height=height, deviceScaleFactor=1,
                  mobile=phone)
        self.call('Emulation.setTouchEmulationEnabled', enabled=phone)
        self.call('Page.navigate', url=url)

    def wait_for(self, expression, seconds=120):
        """Waits until an expression of JavaScript is true."""
        end = time.time() + seconds
        while not self.value(f'Boolean({expression})'):
            if self.log or time.time() > end:
                raise RuntimeError(f'{expression} stays false: {self.log}')
            time.sleep(0.02)

    def open(self, path, width=1280, height=800, phone=False):
        """Opens a file as a double click does. Returns the seconds until the first picture."""
        start = time.time()
        self.load('file://' + os.path.abspath(path), width, height, phone)
        self.wait_for('window.libatlas && libatlas.viewer && libatlas.viewer.frames')
        first = time.time() - start
        self.value('libatlas.ready.then(() => true)')
        return first

    def value(self, expression):
        """Evaluates JavaScript, waiting for promises."""
        answer = self.call('Runtime.evaluate', expression=expression, awaitPromise=True,
                           returnByValue=True)
        if 'exceptionDetails' in answer:
            raise RuntimeError(f'{expression}: {json.dumps(answer["exceptionDetails"])[:1000]}')
        return answer['result'].get('value')

    def settle(self):
        """Waits until the page draws nothing more."""
        self.value('new Promise((done) => { const look = () => libatlas.viewer.asked '
                   '? setTimeout(look, 20) : setTimeout(done, 60); look(); })')

    def screenshot(self):
        """Returns a PNG file."""
        return base64.b64decode(self.call('Page.captureScreenshot')['data'])

    def key(self, key, code='', text=None):
        self.press(key, code, text)
        self.release(key, code)

    def press(self, key, code='', text=None):
        keys = {'Tab': 9, 'Escape': 27, 'Enter': 13}
        parameters = {'type': 'keyDown', 'key': key, 'code': code or key}
        if key in keys:
            parameters['windowsVirtualKeyCode'] = keys[key]
        if text:
            parameters['text'] = text
        self.call('Input.dispatchKeyEvent', **parameters)

    def release(self, key, code=''):
        self.call('Input.dispatchKeyEvent', type='keyUp', key=key, code=code or key)

    def mouse(self, kind, x, y, held=True):
        self.call('Input.dispatchMouseEvent', type='mouse' + kind, x=x, y=y, clickCount=1,
                  button='left' if held or kind == 'Released' else 'none', buttons=1 if held else 0)
