"""A mosquitto on free ports of the loopback, a link to it that can be cut, and a client: for tests and campaigns of live systems."""
import json
import os
import select
import shutil
import socket
import struct
import subprocess
import sys
import threading
import time

MOSQUITTO = shutil.which('mosquitto') or '/usr/sbin/mosquitto'


def free_port():
    with socket.socket() as s:
        s.bind(('127.0.0.1', 0))
        return s.getsockname()[1]


def wait_for(what, condition, seconds=20):
    began = time.monotonic()
    while time.monotonic() - began < seconds:
        found = condition()
        if found:
            return found, time.monotonic() - began
        time.sleep(0.02)
    sys.exit(f'{os.path.basename(sys.argv[0])}: expected {what} within {seconds} s, found none')


class Broker:
    """mosquitto with a port for MQTT, and one for websockets that serves the folder `page`. `more`: lines of its configuration."""

    def __init__(self, folder, page, more='persistence false\n'):
        self.mqtt, self.web = free_port(), free_port()
        self.file = os.path.join(folder, 'broker.conf')
        with open(self.file, 'w') as f:
            f.write(f'allow_anonymous true\nlog_dest none\n{more}'
                    f'{"user root" if os.geteuid() == 0 else ""}\nlistener {self.mqtt} 127.0.0.1\n'
                    f'listener {self.web} 127.0.0.1\nprotocol websockets\nhttp_dir {page}\n')
        self.start()

    def start(self):
        self.process = subprocess.Popen([MOSQUITTO, '-c', self.file], stderr=subprocess.DEVNULL)
        wait_for('an answer of the broker', self.answers)

    def answers(self):
        with socket.socket() as s:
            return s.connect_ex(('127.0.0.1', self.web)) == 0

    def stop(self):
        self.process.terminate()
        self.process.wait()

    def publish(self, topic, payload, retained=True):
        subprocess.run(['mosquitto_pub', '-p', str(self.mqtt), '-t', topic, '-q', '1', '-s'] + ['-r'] * retained,
                       input=payload if isinstance(payload, bytes) else json.dumps(payload).encode(), check=True)

    def retained(self, topic):
        found = subprocess.run(['mosquitto_sub', '-p', str(self.mqtt), '-t', topic, '-C', '1', '-W', '5'],
                               capture_output=True, check=False).stdout
        return json.loads(found) if found else None


class Link:
    """Passes bytes between `port`, its own, and another port of this machine, until it is cut."""

    def __init__(self, to):
        self.to, self.is_up, self.pairs, self.stopped = to, True, {}, False
        self.listener = socket.create_server(('127.0.0.1', 0), backlog=8)
        self.port = self.listener.getsockname()[1]
        self.thread = threading.Thread(target=self.run, daemon=True)
        self.thread.start()

    def run(self):
        while not self.stopped:
            ready, _, _ = select.select([self.listener, *self.pairs], [], [], 0.05)
            if not self.is_up:
                self.drop_all()
            for s in ready:
                if s is self.listener:
                    self.accept()
                elif s in self.pairs:
                    self.forward(s)
        self.drop_all()
        self.listener.close()

    def accept(self):
        near, _ = self.listener.accept()
        try:
            if not self.is_up:
                raise OSError
            far = socket.create_connection(('127.0.0.1', self.to), timeout=2)
        except OSError:
            near.close()
            return
        for s in (near, far):
            s.settimeout(10)
            s.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.pairs[near], self.pairs[far] = far, near

    def forward(self, s):
        try:
            data = s.recv(1 << 16)
            if not data:
                raise OSError
            self.pairs[s].sendall(data)
        except OSError:
            self.drop(s)

    def drop(self, s):
        other = self.pairs.pop(s, None)
        self.pairs.pop(other, None)
        for one in (s, other):
            if one is not None:
                one.close()

    def drop_all(self):
        for s in list(self.pairs):
            self.drop(s)

    def stop(self):
        self.stopped = True
        self.thread.join()


class Client:
    """MQTT 3.1.1. Publications with confirmation (QoS 1) are sent again after a break until the broker has confirmed them."""

    def __init__(self, port, name, topics=()):
        self.port, self.name, self.topics = port, name, topics
        self.socket, self.data, self.next_id, self.retry_at = None, b'', 0, 0
        self.unconfirmed = {}  # id: (packet, tag), in the order in which they were sent
        self.confirmed, self.breaks, self.messages = [], 0, []
        self.pinged = time.monotonic()

    def connect(self):
        self.data = b''
        try:
            self.socket = socket.create_connection(('127.0.0.1', self.port), timeout=5)
            self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            self.socket.sendall(self.packet(0x10, b'\0\4MQTT\4\2' + struct.pack('>H', 60) + self.text(self.name)))
            if self.read_exactly(4)[3] != 0:
                raise OSError('refused')
            for topic in self.topics:
                self.socket.sendall(self.packet(0x82, struct.pack('>H', 65535) + self.text(topic) + b'\1'))
            for packet, _ in self.unconfirmed.values():
                self.socket.sendall(bytes([packet[0] | 8]) + packet[1:])  # again
        except (OSError, IndexError):
            self.lose()

    def read_exactly(self, size):
        data = b''
        while len(data) < size:
            more = self.socket.recv(size - len(data))
            if not more:
                raise OSError('closed')
            data += more
        return data

    def lose(self):
        if self.socket is not None:
            self.socket.close()
            self.breaks += 1
        self.socket, self.retry_at = None, time.monotonic() + 0.3

    @staticmethod
    def text(value):
        value = value if isinstance(value, bytes) else value.encode()
        return struct.pack('>H', len(value)) + value

    @staticmethod
    def packet(kind, body):
        size, head = len(body), bytes([kind])
        while True:
            head += bytes([size % 128 | (0x80 if size >= 128 else 0)])
            size //= 128
            if size == 0:
                return head + body

    def publish(self, topic, payload, tag=None, confirmed=True, retained=False):
        """`tag`: what `confirmed` gets when the broker has the message."""
        if not confirmed:
            return self.send(self.packet(0x30 | retained, self.text(topic) + payload))
        self.next_id = self.next_id % 60000 + 1
        packet = self.packet(0x32 | retained, self.text(topic) + struct.pack('>H', self.next_id) + payload)
        self.unconfirmed[self.next_id] = (packet, tag)
        self.send(packet)

    def send(self, packet):
        try:
            if self.socket is not None:
                self.socket.sendall(packet)
        except OSError:
            self.lose()

    def poll(self, seconds=0.0):
        """Takes what has come; waits at most this long for it."""
        if self.socket is None:
            if time.monotonic() >= self.retry_at:
                self.connect()
            else:
                time.sleep(min(seconds, 0.05))
            return
        try:
            if time.monotonic() - self.pinged > 20:
                self.pinged = time.monotonic()
                self.socket.sendall(b'\xc0\0')
            while select.select([self.socket], [], [], seconds)[0]:
                data = self.socket.recv(1 << 16)
                if not data:
                    raise OSError('closed')
                self.data += data
                seconds = 0
                self.take()
        except OSError:
            self.lose()

    def take(self):
        while len(self.data) >= 2:
            size, place, shift = 0, 1, 0
            while True:
                if place >= len(self.data):
                    return
                size |= (self.data[place] & 127) << shift
                shift, place = shift + 7, place + 1
                if self.data[place - 1] < 128:
                    break
            if len(self.data) < place + size:
                return
            kind, body, self.data = self.data[0], self.data[place:place + size], self.data[place + size:]
            if kind & 0xf0 == 0x40:
                entry = self.unconfirmed.pop(struct.unpack('>H', body[:2])[0], None)
                if entry is not None:
                    self.confirmed.append(entry[1])
            elif kind & 0xf0 == 0x30:
                length, = struct.unpack('>H', body[:2])
                topic, rest = body[2:2 + length].decode(errors='replace'), body[2 + length:]
                if kind & 6:
                    self.socket.sendall(b'\x40\2' + rest[:2])
                    rest = rest[2:]
                self.messages.append((time.time(), topic, rest))

    def close(self):
        if self.socket is not None:
            self.send(b'\xe0\0')
        self.lose()


def sensor_payload(channels, sequence, when, interval, samples):
    """Bytes of smartrock/ID/imu; `samples`: a list of lists of numbers."""
    numbers = [x for sample in samples for x in sample]
    return struct.pack('<BBHIdf', 1, channels, len(samples), sequence & 0xffffffff, when, interval) + struct.pack(f'<{len(numbers)}f', *numbers)
