#!/usr/bin/env python3
"""The live page in headless Chromium, with a mosquitto of its own on free ports of the loopback.

Checks that the pose of a rock on screen is the published one, that an alarm appears within a second, that a
changed setting is published retained and its acknowledgement is shown, and that the page is back after a restart
of the broker; that it does not fall behind 400 rocks at 10 Hz; what page_checks.py says of keyboard, sizes and colours, page_hostile.py of hostile
messages, and real_runs.py of real runs of live_triaxial and monitor. Prints what it measures. Exit code 77: skipped, a program is missing.
page_test.py PAGE_FOLDER [--bin FOLDER] [--pictures FOLDER] [--bodies N] [--only NAME]
page_test.py PAGE_FOLDER --sources: only whether the page was built from its sources as they are.
"""
import argparse
import hashlib
import math
import os
import random
import re
import shutil
import struct
import sys
import tempfile
import time

from broker import MOSQUITTO, Broker, Client, wait_for
from browser import Browser
from page_checks import check_frames, check_keyboard, check_sizes_and_colours
from page_hostile import beat, check_age, check_hostile, check_login, check_many, check_policy
from real_runs import check_monitor, check_triaxial


def scene_and_poses(bodies, clump):
    """A column of rocks; the first ten have sensors."""
    generator = random.Random(1)
    reach = max(math.dist((0, 0, 0), b[:3]) + b[3] for b in clump)
    scene = {'title': 'Triaxial test with SmartRocks', 'shapes': {'0': [[x / reach for x in b] for b in clump]},
             'bodies': [[k, 0, 0.022, k + 1 if k < 10 else 0] for k in range(bodies)]}
    poses = []
    for _ in range(bodies):
        r, a, q = 0.14 * math.sqrt(generator.random()), 2 * math.pi * generator.random(), [generator.gauss(0, 1) for _ in range(4)]
        norm = math.hypot(*q)
        poses.append([r * math.cos(a), r * math.sin(a), 0.6 * generator.random(), *(x / norm for x in q)])
    return scene, poses


def pose_parts(poses, when, bodies=None):
    """Topics and payloads of bris/poses."""
    size = 140
    return [(f'bris/poses/{k // size}', struct.pack('<IIdI', 2, len(poses) if bodies is None else bodies, when, k) +
             b''.join(struct.pack('<7f', *p) for p in poses[k:k + size])) for k in range(0, len(poses), size)]


def read_clump(file):
    with open(file) as f:
        rows = [line.split(',') for line in f if line.strip() and not line.startswith('#')]
    return [[float(x) for x in row[:4]] for row in rows if row[0].strip().lstrip('-').replace('.', '', 1).replace('e-', '', 1).isdigit()]


def check_pose(browser, poses, body):
    shown = browser.value(f'(() => {{ const p = bris.rocks.placed[{body}]; return [...p.position.toArray(), p.attitude.w, '
                          'p.attitude.x, p.attitude.y, p.attitude.z]; })()')
    error = max(abs(a - b) for a, b in zip(shown, poses[body]))
    assert error < 1e-6, f'expected the pose {poses[body]}, found {shown}'
    # the sphere of the body nearest to the camera must be where the projection says: the pixel is not the background
    instance = browser.value('(() => { const m = bris.rocks.mesh.geometry.attributes.ball.array, b = bris.rocks.bodies; let k = 0; '
                             f'for (let i = 0; i < {body}; ++i) k += b[i].balls.length; '
                             f'return [m[16 * k], m[16 * k + 1], m[16 * k + 2], b[{body}].balls[0], b[{body}].radius]; }})()')
    x, y, z, ball, radius = instance
    w, i, j, k = poses[body][3:]
    v = [radius * c for c in ball[:3]]
    cross = lambda a, b: [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    u = [i, j, k]
    t = [2 * c for c in cross(u, v)]
    turned = [v[n] + w * t[n] + cross(u, t)[n] for n in range(3)]
    place = max(abs(a - b - c) for a, b, c in zip((x, y, z), turned, poses[body]))
    assert place < 1e-6, f'a sphere of body {body} is {place} m from where its pose puts it'
    return error, place


def check_messages(a, browser, broker):
    """Poses, alarms, settings, and the broker's restart."""
    state = lambda: browser.value('document.getElementById("connection").dataset.state')
    client = Client(broker.mqtt, 'test')
    client.connect()
    clump = read_clump(os.path.join(a.page, '..', 'clumps', 'rock_01.csv'))
    scene, poses = scene_and_poses(a.bodies, clump)
    broker.publish('bris/scene', scene)
    for part in pose_parts(poses, 0.01):
        broker.publish(*part)
    wait_for('poses', lambda: browser.value('bris.rocks.placed && bris.rocks.placed.length') == a.bodies)
    errors = [check_pose(browser, poses, b) for b in (0, 7, a.bodies - 1)]
    print(f'poses: {a.bodies} rocks of {len(clump)} spheres, largest error {max(map(max, errors)):.2g} m')

    for bad in (pose_parts([[2.0] * 7] * (a.bodies - 1), 1), pose_parts([[2.0] * 7] * (a.bodies + 1), 1, a.bodies), [('bris/poses/0', b'\x02')]):
        broker.publish(*bad[0])  # does not fit the scene
    broker.publish('bris/scene', b'not JSON', False)
    alarm = lambda kind, words, reason: {'state': kind, 'verdict': words, 'reason': reason, 't': 0.01, 'run': 'test'}
    beat(client, 'test')
    broker.publish('smartrock/3/alarm', alarm('active', 'left out', 'gravity: found 12 m/s2'))
    shown = 'document.querySelector("#alarms li.alarm[data-sensor=\'3\']") !== null'
    began = time.monotonic()
    wait_for('an alarm', lambda: browser.value(shown), 1)
    print(f'alarm: shown {time.monotonic() - began:.3f} s after its publication')

    broker.publish('bris/health', {'messages': 4000, 'machine_records': 80, 'breaks': 0, 'dropped': 0, 'sensors': [
        {'id': k, 'status': 'online', 'samples': 400, 'missing': k % 3, 'duplicates': 0, 'refused': 0, 'battery': 3.7}
        for k in range(1, 11)]})
    wait_for('sensors', lambda: browser.value('document.querySelectorAll("#sensors tr").length') >= 10)
    browser.value('(() => { document.getElementById("config-sensor").value = "4"; document.getElementById("config-rate").value = "50"; '
                  'document.getElementById("config-strategy").value = "triggered"; document.getElementById("settings").requestSubmit(); })()')
    config, _ = wait_for('a retained configuration', lambda: broker.retained('smartrock/4/config'))
    assert (config['rate_hz'], config['strategy'], config['threshold']) == (50, 'triggered', 5), config
    shown = 'document.getElementById("config-state").textContent'
    assert 'not acknowledged' in browser.value(shown)
    broker.publish('smartrock/4/config/ack', {'accepted': True, 'revision': config['revision']})
    _, waited = wait_for('an acknowledgement', lambda: browser.value(shown) == 'sensor 4: acknowledged', 5)
    print(f'setting: published retained, acknowledgement shown within {waited:.3f} s')
    check_sizes_and_colours(browser, a.pictures)
    check_keyboard(browser)
    many, poses = scene_and_poses(400, clump)
    check_frames(browser, broker, many, pose_parts, poses)

    broker.stop()
    wait_for('a page without connection', lambda: state() == 'broken')
    wait_for('a page that is grey', lambda: browser.value('document.body.dataset.stale') == 'gone')
    broker.start()
    _, waited = wait_for('a page that is back', lambda: state() == 'connected', 30)
    client = Client(broker.mqtt, 'test')
    client.connect()
    beat(client, 'test')
    broker.publish('smartrock/3/alarm', alarm('clear', 'in use', ''))
    wait_for('the end of the alarm', lambda: browser.value('bris.alarms.state("sensor 3")') == 'clear')
    client.close()
    print(f'restart of the broker: the page is back {waited:.2f} s later and subscribed')


def check_sources(page):
    """The page names the hash of the sources from which it was built."""
    sources = os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', '..', 'scenarios', 'monitoring', 'page')
    names = sorted(n for n in os.listdir(sources) if n.endswith(('.js', '.css', '.html', '.mjs', '.json')))
    found = hashlib.sha256()
    for name in names:
        with open(os.path.join(sources, name), 'rb') as f:
            found.update(f.read())
    with open(os.path.join(page, 'index.html')) as f:
        built = re.search(r'<meta name="sources" content="([0-9a-f]*)">', f.read())[1]
    assert built == found.hexdigest(), 'assets/live_page/index.html is older than its sources: npm ci && npm run build in scenarios/monitoring/page'


def main(a, folder):
    if a.pictures:
        os.makedirs(a.pictures, exist_ok=True)
    broker = Broker(folder, os.path.abspath(a.page))
    url = f'http://127.0.0.1:{broker.web}/index.html'
    browser = Browser(folder, url)
    try:
        checks = {'triaxial': lambda: check_triaxial(browser, broker, a.bin, folder), 'monitor': lambda: check_monitor(browser, broker, a.bin, folder),
                  'policy': lambda: check_policy(browser), 'login': lambda: check_login(browser, url), 'age': lambda: check_age(browser, broker, url),
                  'hostile': lambda: check_hostile(browser, broker), 'messages': lambda: check_messages(a, browser, broker),
                  'many': lambda: check_many(browser, broker)}
        for name, check in checks.items():
            if a.only and name not in a.only.split(','):
                continue
            browser.call('Page.navigate', url=url)
            wait_for('a connected page', lambda: browser.value('document.getElementById("connection").dataset.state') == 'connected', 60)
            check()
            if a.pictures:
                time.sleep(1)
                browser.picture(os.path.join(a.pictures, f'{name}.png'), whole=True)
    finally:
        browser.close()
        broker.stop()


if __name__ == '__main__':
    parser = argparse.ArgumentParser()
    parser.add_argument('page')
    parser.add_argument('--bin', default=os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', '..', 'build', 'bin'),
                        help='Folder of the programs.')
    parser.add_argument('--only', help='Names of checks, separated by commas.')
    parser.add_argument('--sources', action='store_true')
    parser.add_argument('--pictures', help='Folder for pictures of the page on a phone and on a desk, light and dark.')
    parser.add_argument('--bodies', type=int, default=100)
    arguments = parser.parse_args()
    check_sources(arguments.page)
    if arguments.sources:
        sys.exit(0)
    missing = [p for p in (MOSQUITTO, 'mosquitto_pub', 'chromium') if not shutil.which(p)]
    if missing:
        print(f'skipped: {", ".join(missing)} not installed (Debian: mosquitto mosquitto-clients chromium)')
        sys.exit(77)
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as place:
        main(arguments, place)
