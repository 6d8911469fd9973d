#!/usr/bin/python3
"""Campaigns in parts: two parts at once, one of them killed and started again, merged, give the table of the campaign without parts, in
every campaign that has --part, and so do two processes of mpirun. The programs are stand-ins that take a moment and write numbers that
depend on their options only."""
import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

sys.dont_write_bytecode = True
import seed_campaign
from proportion import clopper_pearson

HERE = Path(__file__).resolve().parent
STAND_IN = '''#!/usr/bin/python3
import hashlib, json, os, sys, time
from pathlib import Path
assert 'OMPI_COMM_WORLD_SIZE' not in os.environ  # this is no rank
words = sys.argv[1:]
out = Path(words[words.index('--out') + 1])
options = [w for k, w in enumerate(words) if '--out' not in (w, words[k - 1]) and '--resume' not in (w, words[k - 1])]
time.sleep(0.03)
def number(key):
    return 0.5 + int(hashlib.sha256((key + ' '.join(options)).encode()).hexdigest()[:6], 16) / 2**25
class Any(dict):
    pass
keys = json.loads(Path(sys.argv[0]).with_name('keys.json').read_text())
pressures = [''] + ['55kPa_', '110kPa_', '165kPa_']
for folder in ('', '55kPa', '110kPa', '165kPa'):
    (out / folder).mkdir(parents=True, exist_ok=True)
    (out / folder / 'summary.json').write_text(json.dumps({p + k: number(folder + p + k) for p in pressures for k in keys}))
(out / 'layouts.csv').write_text('sensors,layout,interval,sensor_rocks_error_ratio,near_error_ratio,others_error_ratio,seconds_per_stage\\n'
                                 + f'10,rings,1e-3,{number("a")},{number("b")},{number("c")},0.1\\n')
'''
VARIANTS = ('inserted', 'spread', 'nudged', 'learned', 'both', 'ensemble', 'analysis', 'null', 'load_cell', 'free', 'perturbed')
RATIOS = ('q', 'q_to_2_percent', 'q_to_4_percent', 'volumetric_strain', 'volumetric_strain_to_2_percent', 'volumetric_strain_to_4_percent', 'ring_strain',
          'sensor_displacement', 'ring_radius', 'displacement_sensors', 'displacement_shell_1', 'rotation_sensors')
LEARNED = ('learned_friction', 'learned_friction_deviation', 'learned_stiffness_ratio', 'learned_stiffness_ratio_deviation', 'learned_squared_distance_of_truth')
RESULTS = ('measurements_accepted', 'measurements_refused', 'sensors_inconsistent_from', 'sensors_refused')


def keys_of_triaxial():
    text = (HERE / 'triaxial_campaign').read_text()
    scope = {}
    exec(text[text.index('KEYS ='):text.index('FACTORS =')], scope)
    return scope['KEYS']


def stand_ins(folder):
    folder.mkdir()
    keys = [*keys_of_triaxial(), *LEARNED, *(f'error_ratio_{name}' for name in RATIOS)]
    keys += [f'{variant}_{name}' for variant in VARIANTS for name in (*LEARNED, *RESULTS, *(f'error_ratio_{ratio}' for ratio in RATIOS))]
    (folder / 'keys.json').write_text(json.dumps(keys))
    for name in ('smart_triaxial', 'triaxial', 'twin'):
        (folder / name).write_text(STAND_IN)
        (folder / name).chmod(0o755)
    return folder


def check(campaign, words, programs, folder):
    tables = {}
    def command(kind, *more):
        work = folder / kind
        work.mkdir(parents=True, exist_ok=True)
        tables[kind] = [work / 'table.csv']
        return [str(word) for word in (sys.executable, HERE / campaign, *words, '--bin', programs, '--threads', 1, '--work', work / 'runs', '--csv', tables[kind][0], *more)]

    def run(*words):
        done = subprocess.run(command(*words), capture_output=True, text=True)
        assert done.returncode == 0, (campaign, words, done.stdout, done.stderr)
        return done.stdout

    def runs(kind):
        return len(list((folder / kind / 'runs').glob('**/summary.json')))

    run('whole')
    parts = [subprocess.Popen(command('parts', '--part', f'{k}/2'), stdout=subprocess.DEVNULL) for k in (1, 2)]
    while not list((folder / 'parts').glob('table.part_2_of_2.csv')):
        time.sleep(0.01)
    parts[1].send_signal(signal.SIGKILL)
    assert parts[1].wait() == -signal.SIGKILL, f'{campaign}: the part ended before it could be killed'
    assert parts[0].wait() == 0
    run('parts', '--merge')  # of what there is: a later merge adds the rest
    assert tables['parts'][0].read_text() != tables['whole'][0].read_text(), f'{campaign}: nothing was left to do'
    run('parts', '--part', '2/2')
    shown = run('parts', '--merge')
    for whole, parted in zip(tables['whole'], tables['parts']):
        assert whole.exists() == parted.exists()
        if whole.exists():
            assert sorted(whole.read_text().splitlines()) == sorted(parted.read_text().splitlines()), f'{campaign}: other rows'
            assert whole.read_text() == parted.read_text(), f'{campaign}: the rows are in another order'
    assert not list((folder / 'parts').glob('*.part_*')) and not list((folder / 'parts').glob('*.tmp'))
    assert shown.split('\n', 1)[1].count('\n') > 2, f'{campaign}: no report after --merge'
    assert subprocess.run(command('parts', '--part', '3/2'), capture_output=True).returncode == 2
    ranks = [subprocess.Popen(command('ranks'), stdout=subprocess.DEVNULL, env={**os.environ, 'OMPI_COMM_WORLD_SIZE': '2', 'OMPI_COMM_WORLD_RANK': str(k)})
             for k in (0, 1)]  # as mpirun starts them
    assert [rank.wait() for rank in ranks] == [0, 0]
    run('ranks', '--merge')
    assert tables['whole'][0].read_text() == tables['ranks'][0].read_text(), f'{campaign}: other rows under mpirun'
    print(f'{campaign}: the same table, {runs("whole")} runs')


def check_damage(programs, folder):
    """A table that is cut off or has other columns ends a campaign before anything is computed or deleted."""
    folder.mkdir()
    table, part = folder / 'table.csv', folder / 'table.part_1_of_1.csv'
    whole = 'seed,pressure_kPa,quantity,value\n' + ''.join(f'{seed},55,{name},1.5\n' for seed in (1, 2) for name in ('a', 'b', 'c'))

    def refused(what, *more):
        done = subprocess.run([sys.executable, HERE / 'smart_campaign', '--seeds', '1,2', '--bin', programs, '--work', folder / 'runs', '--csv', table, *more],
                              capture_output=True, text=True)
        assert done.returncode == 1 and what in done.stderr and 'Traceback' not in done.stderr, (what, done.stdout, done.stderr)
        assert not (folder / 'runs').exists()

    table.write_text(whole[:-4])
    refused('table.csv:7: expected complete lines')
    table.write_text(whole + '3,55\n')
    refused('table.csv:8: expected 4 columns, found 2')
    table.write_text(whole.replace('seed', 'number'))
    refused('table.csv:1: expected a column seed, found number')
    table.write_text('\n'.join(whole.splitlines()[:5]) + '\n')  # seed 2 is cut off, but not in the part
    part.write_text(whole)
    refused('expected 1 lines of run 2', '--merge')
    assert part.read_text() == whole
    table.unlink(), part.unlink()
    (programs / 'smart_triaxial').write_text('#!/bin/sh\necho no room on the disk\nexit 4\n')
    done = subprocess.run([sys.executable, HERE / 'smart_campaign', '--seeds', '1', '--bin', programs, '--work', folder / 'runs', '--csv', table],
                          capture_output=True, text=True)
    assert done.returncode == 1 and 'ended with code 4: no room on the disk' in done.stderr, done.stderr
    print('damaged tables are refused')


def check_origin(programs, folder):
    """Two campaigns on one table, or in one folder, and rows of other options, another commit or none: nothing is lost or reused in silence."""
    folder.mkdir()
    (programs / 'slow').mkdir()
    slow = programs / 'slow' / 'smart_triaxial'
    slow.write_text(f'#!/bin/sh\necho begun >{folder}/begun\nsleep 1\nexec {programs}/smart_triaxial "$@"\n')
    slow.chmod(0o755)

    def command(*more, campaign='smart_campaign', bin=programs, csv='table.csv', work='runs', seeds='1,2'):
        return [str(word) for word in (sys.executable, HERE / campaign, '--seeds', seeds, '--bin', bin, '--work', folder / work, '--csv', folder / csv, *more)]

    def run(*more, **how):
        return subprocess.run(command(*more, **how), capture_output=True, text=True)

    def refused(what, *more, **how):
        done = run(*more, **how)
        assert done.returncode == 1 and what in done.stderr and done.stderr.count('\n') == 1, (what, done.stdout, done.stderr)

    first = subprocess.Popen(command(bin=programs / 'slow'), stdout=subprocess.DEVNULL)
    while not (folder / 'begun').exists():
        time.sleep(0.01)
    refused(f'expected no other campaign at this table, found process {first.pid} (')
    refused('seed_1: expected a folder in which nothing runs', csv='other.csv')
    assert first.wait() == 0
    assert not list(folder.glob('.*.lock')), 'a lock remains'
    rows = (folder / 'table.csv').read_text()
    assert {line.split(',')[0] for line in rows.splitlines()[1:]} == {'1', '2'} and not (folder / 'other.csv').exists()
    assert rows.splitlines()[0].endswith(',commit,made_with')
    assert run().returncode == 0 and (folder / 'table.csv').read_text() == rows

    refused('expected rows that were made with --tilt-only True --without-library False, found', '--tilt-only')
    own = rows.splitlines()[1].split(',')[-2]
    (folder / 'table.csv').write_text(rows.replace(f',{own},', ',abc1234,'))
    complete = run()
    assert complete.returncode == 0 and 'commits: abc1234 (' in complete.stdout, complete.stderr
    refused(f'expected rows of commit {own}, found abc1234 (', seeds='1,2,3')
    assert run('--any-commit', seeds='1,2,3').returncode == 0
    assert {line.split(',')[-2] for line in (folder / 'table.csv').read_text().splitlines()[1:]} == {own, 'abc1234'}
    (folder / 'table.csv').write_text('\n'.join(','.join(line.split(',')[:-2]) for line in rows.splitlines()) + '\n')
    complete = run()
    assert complete.returncode == 0 and 'commits: not recorded (' in complete.stdout, complete.stderr
    refused('found not recorded (', seeds='3')

    done = run(campaign='shear_campaign', csv='shear.csv', work='shear', seeds='1')
    assert 'expected a program' in done.stderr, done.stderr  # there is no stand-in
    (folder / 'shear' / 'seed_1').mkdir(exist_ok=True)
    (folder / 'shear' / 'seed_1' / 'summary.json').write_text('{}')
    origin = folder / 'shear' / 'seed_1.origin.json'
    made = json.loads(origin.read_text())
    origin.write_text(json.dumps(made | {'commit': 'abc1234'}))
    refused(f'expected results of commit {own}, found those of commit abc1234', campaign='shear_campaign', csv='shear.csv', work='shear', seeds='1')
    origin.write_text(json.dumps(made | {'words': [*made['words'], '--speed', '2']}))
    refused('found those of other words', '--any-commit', campaign='shear_campaign', csv='shear.csv', work='shear', seeds='1')
    print('one campaign at a table and in a folder; rows and results of other options or commits are not used')


def check_intervals():
    """Of few and of many runs, next to published quantiles of Student's t and a published exact interval of a proportion."""
    for freedom, published in ((1, 12.706), (9, 2.262), (10, 2.228), (15, 2.131), (30, 2.042), (100, 1.984)):
        assert abs(seed_campaign.student(freedom) - published) < 6e-4, freedom
    assert abs(seed_campaign.half_width([0.0, 1.0] * 8) - 2.131 * (4 / 15) ** 0.5 / 4) < 1e-4
    assert [round(x, 4) for x in clopper_pearson(4, 20)] == [0.0573, 0.4366]
    print('intervals are those of published tables')


check_intervals()
with tempfile.TemporaryDirectory() as name:
    root = Path(name)
    programs = stand_ins(root / 'bin')
    check('smart_campaign', ['--seeds', '1,2,3,4,5,6'], programs, root / 'smart')
    check('triaxial_campaign', ['--seeds', '1,2', '--variants', 'default,report,no_taps,gravity'], programs, root / 'triaxial')
    check('twin_campaign', ['--seeds', '1,2,3,4', '--levels', 'A,B'], programs, root / 'twin')
    check('preparation_campaign', ['gradings', '--seeds', '2', '--bodies', '100'], programs, root / 'preparation')
    check_origin(programs, root / 'origin')
    check_damage(programs, root / 'damage')
