"""The live page fed by real runs: a small live_triaxial that follows a simulated test, and a monitor that is killed."""
import csv
import json
import math
import os
import signal
import subprocess
import time

from broker import Client, sensor_payload, wait_for

ROOT = os.path.abspath(os.path.join(os.path.dirname(__file__), '..', '..'))
SMALL = ['--quiet', '--config', os.path.join(ROOT, 'tests', 'scenarios', 'small', 'specimen.cfg'),
         '--grading', os.path.join(ROOT, 'tests', 'scenarios', 'small', 'grading.csv')]
CHANNELS = (('ax', 'ay', 'az'), ('gx', 'gy', 'gz'), ('mx', 'my', 'mz'), ('strain',), ('ux', 'uy', 'uz'), ('qw', 'qx', 'qy', 'qz'), ('temp',), ('batt',))
FILLED = '''(() => bris.curves.specs.filter((s) => %s.includes(s.topic)).map((s) => {
  const data = bris.curves.data(s);
  return [s.title, data === null ? [] : data.map((column) => column.filter((x) => Number.isFinite(x)).length)];
}))()'''


def rows_of(file):
    with open(file) as f:
        return list(csv.DictReader(line for line in f if not line.startswith('#')))


def payload(row, sequence):
    """A sample of a sensor as it sends it."""
    bits, numbers = 0, []
    for bit, names in enumerate(CHANNELS):
        if all(row.get(name) for name in names):
            bits |= 1 << bit
            numbers += [float(row[name]) for name in names]
    return sensor_payload(bits, sequence, float(row['t']), 0, [numbers])


class Sender:
    """Sends records of sensors and of a test machine in their order, with confirmation."""

    def __init__(self, port):
        self.client, self.sequences = Client(port, 'rocks'), {}
        self.client.connect()

    def sample(self, row):
        sensor = int(row['id'])
        self.sequences[sensor] = self.sequences.get(sensor, -1) + 1
        self.client.publish(f'smartrock/{sensor}/imu', payload(row, self.sequences[sensor]))

    def machine(self, numbers):
        self.client.publish('test_machine/record', json.dumps(numbers).encode())

    def wait(self):
        wait_for('confirmations of all records', lambda: self.client.poll(0.02) or not self.client.unconfirmed, 60)


def check_filled(browser, topics, least=3):
    """Every curve of these messages has every line and band, with so many points."""
    found = browser.value(FILLED % json.dumps(topics))
    for title, counts in found:
        assert counts and all(n >= least for n in counts), f'the curve "{title}" is not filled: {counts}'
    return [title for title, _ in found]


def alarm_counts(browser):
    return browser.value('document.getElementById("alarm-counts").textContent')


def start(binaries, words):
    return subprocess.Popen([os.path.join(binaries, words[0]), *words[1:]], stdout=subprocess.DEVNULL)


def check_triaxial(browser, broker, binaries, folder):
    """live_triaxial from its start to its end."""
    recorded = os.path.join(folder, 'recorded')
    subprocess.run([os.path.join(binaries, 'twin'), '--variants', 'none', '--record', recorded, '--out', os.path.join(folder, 'twin'), *SMALL],
                   check=True, stdout=subprocess.DEVNULL)
    said = []
    run = start(binaries, ['live_triaxial', '--broker', f'127.0.0.1:{broker.mqtt}', '--members', '6', '--learning-strain', '0.001', '--recordings',
                           recorded, '--compare=false', '--threads', '1', '--out', os.path.join(folder, 'model'), *SMALL])
    try:
        def ready():
            said.append(browser.value('document.getElementById("runs").textContent'))
            return browser.value('bris.rocks.bodies.length') >= 60
        _, waited = wait_for('the specimen on the page', ready, 120)
        assert any('specimen' in words or 'members' in words for words in said), said
        print(f'live_triaxial: rocks after {waited:.1f} s; the page said "{max(said, key=len)}"')
        time.sleep(0.5)
        assert alarm_counts(browser).startswith('0 active,') and alarm_counts(browser).endswith(' 0 clear'), alarm_counts(browser)
        sender = Sender(broker.mqtt)
        samples = rows_of(os.path.join(recorded, '55kPa', 'recordings.csv'))
        for k, row in enumerate(rows_of(os.path.join(recorded, '55kPa', 'test.csv'))):
            strain = float(row['axial_strain'])
            while samples and float(samples[0]['strain']) <= strain + 1e-9:
                sender.sample(samples.pop(0))
            sender.machine({**{name: float(x) for name, x in row.items()}, 't': 1.2 * k})
            sender.wait()
            time.sleep(0.1)
        sender.wait()
        assert run.wait(120) == 0
        wait_for('the end of the run', lambda: 'ended at' in browser.value('document.getElementById("runs").textContent'), 10)
        titles = check_filled(browser, ['bris/state', 'bris/timing'])
        assert len(titles) == 5, titles
        agreement = browser.value('[...bris.alarms.alarms].find(([key]) => key === "bris/alarm/agreement")[1]')
        assert agreement['state'] in ('active', 'clear'), agreement
        assert 'lag: the model answered' in browser.value('document.getElementById("lag").textContent')
        print('live_triaxial: filled are', ', '.join(titles), '-', agreement['verdict'], '-', agreement['reason'])
    finally:
        run.kill()


def check_monitor(browser, broker, binaries, folder):
    """A monitor, and its end by SIGKILL."""
    example = os.path.join(folder, 'example')
    subprocess.run([os.path.join(binaries, 'monitor'), '--write-example', example, '--example-sensors', '2', '--example-duration', '8', '--example-passages',
                    '4', '--out', os.path.join(folder, 'made'), '--quiet'], check=True, stdout=subprocess.DEVNULL)
    run = start(binaries, ['monitor', '--broker', f'127.0.0.1:{broker.mqtt}', '--baseline', os.path.join(example, 'baseline'), '--window', '20', '--out',
                           os.path.join(folder, 'day'), '--quiet'])
    try:
        runs = lambda: browser.value('document.getElementById("runs").textContent')
        wait_for('a monitor that is alive', lambda: 'monitor: running' in runs(), 60)
        state = lambda k: browser.value(f'bris.alarms.state("sensor {k}")')
        assert (state(1), state(2)) == ('unknown', 'unknown'), 'an all-clear before anything was judged'
        sender = Sender(broker.mqtt)
        for k, passage in enumerate(sorted(os.listdir(os.path.join(example, 'recordings')))):
            file = os.path.join(example, 'recordings', passage, 'recordings.csv')
            for row in rows_of(file) if os.path.exists(file) else []:
                row['t'] = str(float(row['t']) + 20 * k)
                sender.sample(row)
            sender.wait()
        wait_for('three passages', lambda: '3 passages judged' in runs(), 60)
        # in passages of eight seconds quality control may refuse a clock: that sensor stays unknown
        judged, _ = wait_for('a verdict', lambda: [k for k in (1, 2) if state(k) != 'unknown'])
        browser.value(f'bris.curves.choose("{judged[0]}")')
        wait_for('numbers of its passages', lambda: (browser.value(f'(bris.curves.series.get("bris/sensor/{judged[0]}")?.rows ?? []).length') or 0) >= 3, 20)
        print('monitor: filled are', ', '.join(check_filled(browser, ['bris/sensor/ID'], 2)), '-', alarm_counts(browser))
        run.send_signal(signal.SIGKILL)
        began = time.monotonic()
        wait_for('a page that is grey', lambda: browser.value('document.body.dataset.stale') == 'gone', 10)
        assert (state(1), state(2)) == ('unknown', 'unknown'), 'an all-clear of a monitor that was killed'
        stale = browser.value('document.getElementById("stale").textContent')
        assert 'monitor: gone since' in stale, stale
        print(f'monitor: after SIGKILL grey within {time.monotonic() - began:.2f} s: "{stale}"')
    finally:
        run.kill()
