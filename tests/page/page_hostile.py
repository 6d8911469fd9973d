"""What must not harm the live page: markup and control characters in names, ids of 10 000 characters, ten thousand sensors, a million points, and
scripts and addresses that are not its own. Also whether it knows what is old."""
import json
import time

from broker import Client, wait_for

MARKUP = '<img src=x onerror="window.hacked=1"><script>window.hacked=1</script>'
CONTROL = 'a\u202eb\x1b[31mc\x00d'
LONG = '7' * 10000


def check_policy(browser):
    """The Content-Security-Policy: no script but the page's own, no connection to others; and the login form is not filled from the URL."""
    found = browser.value('''(async () => {
      const refused = [];
      document.addEventListener("securitypolicyviolation", (e) => refused.push(e.effectiveDirective));
      const script = document.createElement("script");
      script.textContent = "window.hacked = 1";
      document.body.append(script);
      const image = document.createElement("div");
      image.innerHTML = '<img src="https://example.org/x.png" onerror="window.hacked = 1">';
      document.body.append(image);
      try { new WebSocket("ws://example.org:9001"); } catch (e) { }
      try { await fetch("https://example.org/"); } catch (e) { }
      try { eval("window.hacked = 1"); } catch (e) { refused.push("eval"); }
      await new Promise((go) => setTimeout(go, 500));
      script.remove(); image.remove();
      return [window.hacked ?? 0, [...new Set(refused)].sort()];
    })()''')
    assert found[0] == 0, 'a script that is not of the page ran'
    for directive in ('connect-src', 'eval', 'img-src', 'script-src-attr', 'script-src-elem'):
        assert directive in found[1], f'expected {directive} to be refused, found {found[1]}'
    print('policy: refused are', ', '.join(found[1]))


def check_login(browser, url):
    """An address in the URL is not used and not offered."""
    browser.call('Page.navigate', url=url + '?broker=ws://127.0.0.1:1&address=ws://127.0.0.1:1')
    wait_for('a connected page', lambda: browser.value('document.getElementById("connection").dataset.state') == 'connected', 30)
    browser.value('document.getElementById("login").hidden = false')
    shown = browser.value('[document.getElementById("address-label").hidden, document.getElementById("address-text").textContent, document.getElementById("login").textContent]')
    assert shown[0] and url.split('/')[2] in shown[1] and '127.0.0.1:1 ' not in shown[2] + ' ', f'the login form shows {shown}'
    browser.value('document.getElementById("login").hidden = true')
    print('login: the broker is', shown[1].split()[-1])


def beat(client, run, when=None, **more):
    client.publish(f'bris/run/{run}', json.dumps({'state': 'running', 'time': time.time() if when is None else when, 'began': 1, 'beat': 1,
                   'doing': 'testing', 'left_s': None, 'silent_s': 0, **more}).encode(), confirmed=True, retained=True)
    client.poll(0.01)


def text(browser, element):
    return browser.value(f'document.getElementById("{element}").textContent')


def check_hostile(browser, broker):
    client = Client(broker.mqtt, 'hostile')
    client.connect()
    beat(client, 'hostile', doing=MARKUP)
    client.publish('bris/scene', json.dumps({'title': MARKUP, 'shapes': {'__proto__': [[0, 0, 0, 1]]}, 'bodies': [[1, '__proto__', 0.02, 0]]}).encode(), retained=True)
    for name in (LONG, MARKUP.replace('/', ''), '__proto__', 'constructor'):
        client.publish(f'smartrock/{name}/alarm', json.dumps({'state': 'active', 'verdict': MARKUP, 'reason': CONTROL + 'x' * 100000, 't': 1, 'run': 'hostile'}).encode())
        client.publish(f'smartrock/{name}/config', json.dumps({'revision': MARKUP, 'rate_hz': MARKUP, 'strategy': CONTROL}).encode())
    client.publish(f'bris/alarm/{LONG}', json.dumps({'state': MARKUP, 'verdict': [1, 2], 'reason': {'a': MARKUP}, 'run': 'hostile'}).encode())
    client.publish('bris/health', json.dumps({'messages': MARKUP, 'sensors': [{'id': LONG, 'status': MARKUP, 'samples': MARKUP, 'battery': CONTROL}, None, 7, [[]]]}).encode())
    client.publish('bris/numbers', json.dumps({'curves': [{'title': MARKUP, 'axis': MARKUP, 'topic': 'bris/state', 'over': '__proto__', 'factor': 'x', 'lines': [None, 3]}]}).encode())
    for payload in (b'null', b'7', b'"x"', b'[' * 100000, b'{"__proto__": {"hacked": 1}}', b'\xff\xfe'):
        for topic in ('bris/state', 'bris/health', 'bris/numbers', 'bris/run/x', 'bris/run/x/gone', 'bris/alarm/x', 'smartrock/1/alarm', 'bris/timing', 'bris/scene'):
            client.publish(topic, payload)
    client.poll(0.5)
    wait_for('hostile alarms', lambda: beat(client, 'hostile') or text(browser, 'alarm-counts').startswith('4 active'))
    wait_for('a hostile title', lambda: text(browser, 'title').startswith('<img'))
    found = browser.value('''[window.hacked ?? 0, ({}).hacked ?? 0, document.querySelectorAll("img").length, document.querySelectorAll("script").length,
      document.documentElement.scrollWidth <= innerWidth, Math.max(...[...document.querySelectorAll("li, td, h1, p")].map(e => e.textContent.length)),
      /[\\u0000-\\u0008\\u001b\\u202e]/.test(document.body.textContent)]''')
    assert found[:5] == [0, 0, 0, 1, True] and found[5] < 2000 and not found[6], f'hostile texts: {found}'
    for topic in (f'smartrock/{LONG}/alarm', f'bris/alarm/{LONG}', 'bris/scene'):
        client.publish(topic, b'', retained=True)
    client.poll(0.2)
    client.close()
    print('hostile texts: shown as text, at most', found[5], 'characters each')


def check_age(browser, broker, url):
    """A run that is alive, hangs, has another clock, dies, was killed yesterday."""
    client = Client(broker.mqtt, 'ages')
    client.connect()
    kind = lambda: browser.value('document.body.dataset.stale')
    runs = lambda: text(browser, 'runs')
    beat(client, 'today', doing='making the specimen', left_s=65)
    wait_for('a run that is alive', lambda: kind() == '' and 'making the specimen; until' in runs())
    beat(client, 'today', when=time.time() - 7200)
    wait_for('a clock that is behind', lambda: 'its clock is 2 h behind this one' in runs())
    beat(client, 'today', silent_s=90)
    wait_for('a computation that hangs', lambda: 'no sign of its computation for' in runs())
    client.publish('smartrock/9/alarm', json.dumps({'state': 'clear', 'verdict': 'as the baseline', 'reason': '', 't': 1, 'run': 'today'}).encode(), retained=True)
    beat(client, 'today')
    state = lambda: browser.value('bris.alarms.state("sensor 9")')
    wait_for('an all-clear', lambda: state() == 'clear')
    began = time.monotonic()
    wait_for('a page that is grey', lambda: kind() == 'gone', 10)
    print(f'age: grey {time.monotonic() - began:.1f} s after the last sign of life: "{text(browser, "stale")}"')
    assert state() == 'unknown', 'an all-clear of a run that is not alive'
    assert browser.value('getComputedStyle(document.querySelector("main")).filter') == 'grayscale(1)'
    beat(client, 'today')
    wait_for('a page that is current again', lambda: kind() == '' and state() == 'clear')
    client.publish('bris/run/today/gone', b'{"gone": true}', retained=True)
    client.poll(0.1)
    _, waited = wait_for('a run that is gone', lambda: kind() == 'gone' and 'gone since' in runs(), 2)
    beat(client, 'today', when=time.time() - 86400)
    client.publish('bris/run/today/gone', b'{"gone": true}', retained=True)
    client.poll(0.1)
    browser.call('Page.navigate', url=url)  # what the broker has kept is of yesterday
    wait_for('a connected page', lambda: browser.value('document.getElementById("connection").dataset.state') == 'connected', 30)
    wait_for('a run of yesterday', lambda: kind() == 'gone' and '24 h ago' in text(browser, 'stale'), 10)
    assert state() == 'unknown'
    print(f'age: gone {waited:.2f} s after the last will; of yesterday: "{text(browser, "stale")}"')
    client.publish('smartrock/9/alarm', b'', retained=True)
    client.poll(0.1)
    client.close()


def check_many(browser, broker):
    """Ten thousand sensors and a million points."""
    client = Client(broker.mqtt, 'many')
    client.connect()
    beat(client, 'many')
    began = time.monotonic()
    for k in range(1, 10001):
        client.publish(f'smartrock/{k}/alarm', json.dumps({'state': 'active' if k == 9999 else 'clear', 'verdict': 'x', 'reason': '', 't': 1, 'run': 'many'}).encode(), confirmed=False)
        if k % 500 == 0:
            beat(client, 'many')
    client.publish('bris/health', json.dumps({'messages': 1, 'sensors': [{'id': k, 'status': 'online', 'samples': k} for k in range(1, 10001)]}).encode())
    wait_for('ten thousand sensors', lambda: beat(client, 'many') or (browser.value('bris.sensors.sensors.size') or 0) >= 10000, 60)
    wait_for('their alarms', lambda: beat(client, 'many') or '1 active' in text(browser, 'alarm-counts'), 30)
    wait_for('the most serious sensor first', lambda: browser.value('document.querySelector("#sensors tr td").textContent') == '9999', 10)
    rows, first = browser.value('[document.querySelectorAll("#sensors tr").length, document.querySelector("#sensors tr td").textContent]')
    assert rows <= 200 and first == '9999', f'{rows} rows, the first of sensor {first}'
    taken = time.monotonic() - began
    frames = browser.value('''(async () => { const began = performance.now(); let longest = 0, last = began;
      while (performance.now() - began < 3000) { await new Promise((go) => setTimeout(go)); longest = Math.max(longest, performance.now() - last); last = performance.now(); }
      return longest; })()''')
    beat(client, 'many')
    browser.value('document.getElementById("find-sensor").value = "1234"; document.getElementById("find-sensor").dispatchEvent(new Event("input"))')
    wait_for('a sensor that is asked for', lambda: browser.value('document.querySelector("#sensors tr td").textContent') == '1234', 5)
    browser.value('document.getElementById("find-sensor").value = ""')
    print(f'10 000 sensors: shown after {taken:.1f} s, {rows} rows; the longest task of three seconds takes {frames:.0f} ms')
    assert frames < 1500, 'the page cannot be used with ten thousand sensors'
    client.close()
    points = browser.value('''(() => { bris.curves.table({ curves: [{ title: "many", axis: "x", topic: "bris/many", over: "x", factor: 1, axis_factor: 1,
        lines: [{ name: "y", label: "y", half_width: "h" }] }] });
      const began = performance.now();
      for (let k = 0; k < 1e6; ++k) bris.curves.add("bris/many", { x: k, y: k === 654321 ? 100 : Math.sin(k / 1e4), h: 0.1 });
      const added = performance.now() - began, rows = bris.curves.series.get("bris/many").rows;
      const before = performance.now(); bris.curves.draw();
      return [added, performance.now() - before, rows.length, Math.max(...rows.map((r) => r[1]))]; })()''')
    assert points[2] <= 4000 and points[3] == 100, f'a million points: {points}'
    print(f'a million points: added in {points[0] / 1000:.1f} s, {points[2]} kept, the one that stands out too, drawn in {points[1]:.0f} ms')
