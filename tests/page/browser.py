"""Chromium without a window, by its DevTools protocol."""
import base64
import json
import os
import socket
import struct
import subprocess
import urllib.request

from broker import free_port, wait_for


class Browser:
    def __init__(self, folder, url, width=1200, height=1500):
        self.number = 0
        port = free_port()
        self.process = subprocess.Popen(
            ['chromium', '--headless=new', '--no-sandbox', '--disable-dev-shm-usage', '--use-gl=angle',
             '--use-angle=swiftshader', '--enable-unsafe-swiftshader', f'--user-data-dir={folder}/profile',
             f'--window-size={width},{height}', f'--remote-debugging-port={port}', url],
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

        def page():
            try:
                with urllib.request.urlopen(f'http://127.0.0.1:{port}/json', timeout=2) as f:
                    return [t for t in json.load(f) if t['type'] == 'page']
            except OSError:
                return None
        (target, *_), _ = wait_for('Chromium', page, 90)
        self.socket = socket.create_connection(('127.0.0.1', port), timeout=60)
        path = target['webSocketDebuggerUrl'].split(str(port), 1)[1]
        key = base64.b64encode(os.urandom(16)).decode()
        self.socket.sendall(f'GET {path} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n'
                            f'Sec-WebSocket-Key: {key}\r\nSec-WebSocket-Version: 13\r\n\r\n'.encode())
        self.stream = self.socket.makefile('rb')
        while self.stream.readline() not in (b'\r\n', b''):
            pass

    def call(self, method, **parameters):
        self.number += 1
        data = json.dumps({'id': self.number, 'method': method, 'params': parameters}).encode()
        mask = os.urandom(4)
        self.socket.sendall(b'\x81' + (bytes([0x80 | len(data)]) if len(data) < 126 else struct.pack('>BH', 0xfe, len(data)))
                            + mask + bytes(b ^ mask[k % 4] for k, b in enumerate(data)))
        while True:
            answer = json.loads(self.frame())
            if answer.get('id') == self.number:
                return answer['result']

    def frame(self):
        data, final = b'', False
        while not final:
            first, size = self.stream.read(2)
            final = bool(first & 0x80)
            if size == 126:
                size, = struct.unpack('>H', self.stream.read(2))
            elif size == 127:
                size, = struct.unpack('>Q', self.stream.read(8))
            data += self.stream.read(size)
        return data

    def value(self, expression):
        result = self.call('Runtime.evaluate', expression=expression, returnByValue=True, awaitPromise=True,
                           allowUnsafeEvalBlockedByCSP=False)
        if 'exceptionDetails' in result:
            return None
        return result['result'].get('value')

    def picture(self, file, whole=False):
        with open(file, 'wb') as f:
            f.write(base64.b64decode(self.call('Page.captureScreenshot', format='png', captureBeyondViewport=whole)['data']))

    def close(self):
        self.process.terminate()
        self.process.wait()
