"""Checks of the live page that need a browser: speed of the rocks, keyboard, sizes and colours."""
import json
import os
import time

from broker import Client, wait_for

WATCH = '''(() => {
  bris.ages = [];
  let seen;
  const watch = () => {
    if (!bris.ages) return;
    if (bris.rocks.pictures !== seen) {
      seen = bris.rocks.pictures;
      bris.ages.push((performance.timeOrigin + performance.now()) / 1000 - bris.rocks.time);
    }
    requestAnimationFrame(watch);
  };
  watch();
})()'''

FOCUS = '''(() => {
  const e = document.activeElement, s = getComputedStyle(e);
  const label = e.getAttribute("aria-label") ?? e.labels?.[0]?.textContent.trim() ?? e.textContent.trim();
  return [e.id || e.tagName.toLowerCase(), label, s.outlineStyle !== "none" && parseFloat(s.outlineWidth) >= 2];
})()'''

CONTRAST = '''(() => {
  const e = document.querySelector(%s);
  if (!e) return null;
  const parts = (c) => c.match(/[0-9.]+/g).map(Number);
  const channel = (v) => v / 255 <= 0.03928 ? v / 255 / 12.92 : ((v / 255 + 0.055) / 1.055) ** 2.4;
  const light = (c) => 0.2126 * channel(c[0]) + 0.7152 * channel(c[1]) + 0.0722 * channel(c[2]);
  let ground = e;
  while (ground.parentElement && (parts(getComputedStyle(ground).backgroundColor)[3] ?? 1) === 0) ground = ground.parentElement;
  const a = light(parts(getComputedStyle(e).color)), b = light(parts(getComputedStyle(ground).backgroundColor));
  return (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
})()'''


def check_frames(browser, broker, scene, pose_parts, poses, seconds=20, rate=10):
    """Poses of many rocks at 10 Hz: how many messages the page takes, how many pictures it draws, and how old the poses in them are."""
    client = Client(broker.mqtt, 'poses')
    client.connect()
    client.publish('bris/scene', json.dumps(scene).encode(), retained=True)
    client.poll(1)
    wait_for('the scene', lambda: browser.value('bris.rocks.bodies.length') == len(poses))
    taken, pictures = browser.value('bris.rocks.taken'), browser.value('bris.rocks.pictures')
    browser.value(WATCH)
    waiting, began = [], time.monotonic()
    for k in range(seconds * rate):
        while time.monotonic() - began < k / rate:
            client.poll(0.01)
        for part in pose_parts(poses, time.time()):
            client.publish(*part, retained=True)
        if k % rate == rate - 1:
            waiting.append(k + 1 - (browser.value('bris.rocks.taken') - taken))
    end = time.monotonic() - began
    wait_for('all poses', lambda: client.poll(0.05) or browser.value('bris.rocks.taken') - taken == seconds * rate)
    ages = sorted(age for age in browser.value('bris.ages') if age < 1e6)  # not of the poses before
    browser.value('bris.ages = null')
    drawn, spheres = browser.value('bris.rocks.pictures') - pictures, browser.value('bris.rocks.mesh.geometry.drawRange.count / 6')
    client.close()
    print(f'frames: {len(poses)} rocks, {spheres} spheres, {seconds * rate} poses in {end:.1f} s, all taken; {drawn} pictures; messages that wait, each second: '
          f'{waiting}; age of the poses in a picture: median {ages[len(ages) // 2]:.3f} s, largest {ages[-1]:.3f} s')
    # a busy machine may halt the browser for a moment; a page that cannot keep up has more messages waiting each second
    assert sorted(waiting)[len(waiting) // 2] <= rate / 2, f'the page falls behind: {waiting}'


def check_keyboard(browser):
    """Goes through the page by the tab key, turns the rocks and sends settings without a mouse."""
    def press(key, code, text=None):
        browser.call('Input.dispatchKeyEvent', type='keyDown', key=key, windowsVirtualKeyCode=code, **({'text': text} if text else {}))
        browser.call('Input.dispatchKeyEvent', type='keyUp', key=key, windowsVirtualKeyCode=code)

    browser.value('document.activeElement.blur(); window.scrollTo(0, 0)')
    reached = []
    while len(reached) < 12:
        press('Tab', 9)
        found = browser.value(FOCUS)
        if found[0] == 'rocks':
            before = browser.value('bris.rocks.view.turn')
            press('ArrowRight', 39)
            assert browser.value('bris.rocks.view.turn') != before, 'an arrow key does not turn the rocks'
        reached.append(found)
        if found[0] == 'config-send':
            break
    names = [name for name, _, _ in reached]
    print('keyboard:', ', '.join(names))
    # a list that is longer than its place is reached too, to be moved by the arrow keys
    is_long = browser.value('document.getElementById("alarms").scrollHeight > document.getElementById("alarms").clientHeight')
    expected = ['rocks', 'only-sensors', *(['alarms'] if is_long else []), 'find-sensor', 'table-of-sensors', 'config-sensor', 'config-rate', 'config-strategy', 'config-threshold', 'config-send']
    assert names == expected, f'expected the tab order {expected}, found {names}'
    for name, label, is_visible in reached:
        assert label, f'{name} has no name for a screen reader'
        assert is_visible, f'the focus on {name} is not visible'
    revision = 'bris.sensors.get(document.getElementById("config-sensor").value).config?.revision ?? 0'
    before = browser.value(revision)
    press('Enter', 13, '\r')  # on the button
    wait_for('settings that are sent by keyboard', lambda: browser.value(revision) > before, 5)


def check_sizes_and_colours(browser, folder):
    """Nothing is wider than a phone, controls can be touched, and texts have the contrast that WCAG AA asks for, light and dark."""
    for scheme in ('light', 'dark'):
        browser.call('Emulation.setEmulatedMedia', features=[{'name': 'prefers-color-scheme', 'value': scheme}])
        for name, width, height, scale in (('phone', 390, 844, 2), ('desk', 1200, 1500, 1)):
            browser.call('Emulation.setDeviceMetricsOverride', width=width, height=height, deviceScaleFactor=scale, mobile=name == 'phone')
            time.sleep(1)
            if folder:
                browser.picture(os.path.join(folder, f'{name}_{scheme}.png'), whole=True)
            found = browser.value('document.documentElement.scrollWidth')
            assert found <= width, f'expected a page of {width} px on a {name}, found {found}'
            small = browser.value('[...document.querySelectorAll("button, input, select")].filter(e => e.offsetParent && '
                                  'Math.max(e.offsetHeight, e.closest("label")?.offsetHeight ?? 0) < 24).map(e => e.id)')
            assert not small, f'too small to be touched: {small}'
            for sample in ('p.note', 'td', 'label', 'li.alarm', '#connection', 'button', 'h2', 'output'):
                ratio = browser.value(CONTRAST % json.dumps(sample))
                assert ratio is None or ratio >= 4.5, f'{scheme}: expected a contrast of 4.5 of {sample}, found {ratio:.2f}'
    browser.call('Emulation.clearDeviceMetricsOverride')
    browser.call('Emulation.setEmulatedMedia', features=[])
    print('sizes and colours: nothing is wider than 390 px, every contrast is 4.5 or more, light and dark')
