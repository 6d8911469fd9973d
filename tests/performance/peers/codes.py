"""Common parts of the comparisons: the codes, the scenes, and the commands that run each code."""
import csv
import functools
import math
import os
import random
import re
import shutil
import subprocess
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from tables import commit, hold, write  # noqa: E402, F401

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[2]
BUILD = Path(os.environ.get('BRIS_BUILD_DIR', ROOT / 'build'))
BENCH = BUILD / 'bin' / 'peers_bench'
MPIRUN = ['mpirun', '--allow-run-as-root', '--oversubscribe', '--bind-to', 'none', '-np']
NATIVE = BUILD / 'lammps_native.so'  # granular styles of LAMMPS compiled for this machine, made by native_lammps
CODES = {'lammps': 'lmp', 'lammps_native': 'lmp', 'liggghts': 'liggghts', 'yade': 'yade', 'bris': str(BENCH)}
PACKAGES = {'lmp': 'lammps', 'liggghts': 'liggghts', 'yade': 'yade', 'mpirun': 'openmpi-bin'}

# the same as in scene.cpp; skin: m, of the neighbour lists of the other codes (BRIS sets its own); every: steps between rebuilds, 0: when necessary
SCENES = {
    'settle': dict(dt=1e-5, skin=2e-3, kn=1e6, gn=5838, gz=9.81, every=0, rocks=0),
    'fall': dict(dt=1e-5, skin=2e-3, kn=1e6, gn=5838, gz=9.81, every=0, rocks=0),
    'quiet': dict(dt=1e-5, skin=2e-3, kn=1e6, gn=5838, gz=9.81, every=0, rocks=0),
    'shear': dict(dt=1e-5, skin=2e-3, kn=1e6, gn=5838, gz=9.81, every=0, rocks=0),
    'poly': dict(dt=2e-6, skin=6e-4, kn=1e5, gn=20600, gz=1000, every=20, rocks=0),
    'poly5': dict(dt=2e-6, skin=6e-4, kn=1e5, gn=20600, gz=1000, every=20, rocks=0),
    'clumps': dict(dt=2e-5, skin=2e-3, kn=1e6, gn=1250, gz=9.81, every=0, rocks=1),
    'drop': dict(dt=2e-5, skin=2e-3, kn=1e6, gn=1250, gz=9.81, every=0, rocks=1),
    'triaxial': dict(dt=2e-5, skin=2e-3, kn=1e6, gn=1250, gz=0, every=0, rocks=1),
    'triaxial_spheres': dict(dt=1e-5, skin=2e-3, kn=1e6, gn=5838, gz=0, every=0, rocks=0),
}
PRESSED = ['triaxial', 'triaxial_spheres']  # beds under pressure in a box with three moving planes
STRAIN = 0.005  # to which these beds are compressed
PARTS = 20  # of the path, after each of which pressures are printed; the same in moving_walls.hpp, lammps.in and yade.py
# a case: scene, law, spheres, steps after which the codes are compared
BASES = {'settle': 16000, 'clumps': 11880}  # spheres of the bed of which larger beds are made
SHEAR_SPEED = 0.1  # m/s, along x, of the uppermost spheres of a sheared bed; the lowest are held
LONGEST = 900  # s, limit of a run, so that a hanging run does not stop the campaign


def installed(codes):
    """The codes that can be run. Prints the packages that are missing for the others."""
    missing = sorted({PACKAGES[tool] for tool in PACKAGES if not shutil.which(tool)
                      and (tool == 'mpirun' or tool in [CODES[c] for c in codes])})
    if missing:
        print(f'missing Debian packages: apt-get install {" ".join(missing)}', file=sys.stderr)
    if not BENCH.exists():
        sys.exit(f'expected {BENCH}, found none: run scenarios/build everything')
    if 'lammps_native' in codes and not NATIVE.exists():
        print('without lammps_native, which tests/performance/peers/native_lammps makes', file=sys.stderr)
    return [c for c in CODES if c in codes and shutil.which(CODES[c]) and (c != 'lammps_native' or NATIVE.exists())]


def tile(base, spheres, bed):
    """Writes a bed of copies of `base` side by side, as nearly square as possible, with single spheres in random order."""
    head, *lines = base.read_text().splitlines()
    count, *box = head.split()
    x, y, z = map(float, box)
    copies = spheres // int(count)
    across = max(n for n in range(1, math.isqrt(copies) + 1) if copies % n == 0)
    groups = []
    for copy in range(copies):
        old = None
        for line in lines:
            px, py, rest = line.split(maxsplit=2)
            words = [repr(float(px) + copy % across * x), repr(float(py) + copy // across * y), *rest.split()]
            if len(words) == 4 or words[4] != old:
                groups.append([])
            old = words[4] if len(words) > 4 else None
            groups[-1].append(words)
    if len(groups) == spheres:
        random.Random(7).shuffle(groups)
    with open(bed, 'w') as out:
        out.write(f'{spheres} {across * x!r} {copies // across * y!r} {z!r}\n')
        for n, group in enumerate(groups, 1):
            out.writelines(' '.join(words[:4] + [str(n)] * (len(words) - 4)) + '\n' for words in group)


def make_bed(case, work):
    """Makes the bed of a case if necessary. Returns the file that BRIS and Yade read, and the data file of LAMMPS and LIGGGHTS."""
    scene, _, spheres, _ = case
    scene = 'settle' if scene == 'shear' else scene
    bed = work / f'{scene}_{spheres}.txt'
    base = BASES.get(scene, spheres)
    if not bed.exists() and spheres > base:
        tile(make_bed((scene, 'linear', base, 0), work)[0], spheres, bed)
    if not bed.exists():
        print(f'making {bed}', flush=True)
        work.mkdir(parents=True, exist_ok=True)
        part = bed.with_suffix('.part')
        subprocess.run([BENCH, '--make', '--scene', scene, '--spheres', str(spheres), '--threads', str(os.cpu_count()),
                        '--bed', part], check=True)
        part.rename(bed)
    data = bed.with_suffix('.data')
    if not data.exists() or data.stat().st_mtime < bed.stat().st_mtime:
        head, *lines = bed.read_text().splitlines()
        count, *box = head.split()
        if scene in PRESSED:  # planes move outwards, so the box of the data file is larger than theirs
            box = [1.05 * float(side) for side in box]
        rows = [line.split() for line in lines]
        with open(data, 'w') as out:
            out.write(f'bed\n\n{count} atoms\n1 atom types\n\n')
            out.writelines(f'0 {side} {axis}lo {axis}hi\n' for side, axis in zip(box, 'xyz'))
            out.write('\nAtoms\n\n')  # id type diameter density x y z
            out.writelines(f'{n} 1 {2 * float(r[3]):.17g} 2600 {" ".join(r[:3])}\n' for n, r in enumerate(rows, 1))
            if len(rows[0]) > 4:
                out.write('\nMolecules\n\n')
                out.writelines(f'{n} {r[4]}\n' for n, r in enumerate(rows, 1))
    return bed, data


def rough_walls(bed):
    """Heights (m) below and above which the centres of a tenth of the bed's spheres lie."""
    heights = sorted(float(line.split()[2]) for line in bed.read_text().splitlines()[1:])
    return heights[len(heights) // 10], heights[-len(heights) // 10]


def pressures_in(text):
    """Pressures (Pa) on the three moving planes after each part of the path."""
    return [tuple(map(float, line.split()[1:4])) for line in re.findall(r'^pressure .*$', text, re.M)][-PARTS:]


def command(code, case, threads, steps, bed, data, step=None, places='none'):
    """Command that runs a case. `step`: time step (s) instead of the scene's. `places`: file for the positions after the check steps."""
    scene, law, _, check = case
    s = dict(SCENES[scene], dt=step or SCENES[scene]['dt'])
    low, high = rough_walls(bed) if scene == 'shear' else (-1e9, 1e9)
    s.update(low=low, high=high, speed=SHEAR_SPEED if scene == 'shear' else 0, strain=STRAIN if scene in PRESSED else 0)
    if code == 'bris':
        return [BENCH, '--scene', scene, '--law', law, '--bed', bed, '--threads', threads, '--check-steps', check, '--steps', steps,
                '--step', s['dt'], '--low', low, '--high', high, '--speed', s['speed'], '--strain', s['strain'], *(['--positions', places] if places != 'none' else [])]
    values = dict(s, kt=s['kn'] * 2 / 7, gt=s['gn'] / 2, check=check, timed=steps, places=places, keep=int(places != 'none'))
    if code == 'yade':
        return ['yade', '-n', '-x', f'-j{threads}', HERE / 'yade.py', bed, f'law={law}'] + [f'{k}={v}' for k, v in values.items()]
    if scene in PRESSED:
        values.update(zip('xyz', open(bed).readline().split()[1:]))
    values.update(data=data, **({'hertz': int(law == 'hertz')} if code == 'liggghts' else {'law': law}))
    variables = [word for name, value in values.items() for word in ('-var', name, value)]
    preload = ['env', f'LD_PRELOAD={NATIVE}'] if code == 'lammps_native' else []
    run = [*preload, CODES[code], '-in', HERE / f'{code.removesuffix("_native")}.in', '-log', 'none', *variables]
    return [*MPIRUN, threads, *run] if threads > 1 else run


def busy_seconds():
    fields = [int(word) for word in open('/proc/stat').readline().split()[1:9]]
    return (sum(fields) - fields[3] - fields[4]) / os.sysconf('SC_CLK_TCK')


def descendants(pid):
    """A process and all that it has started."""
    try:
        children = open(f'/proc/{pid}/task/{pid}/children').read().split()
    except OSError:  # it has ended
        return [pid]
    return [pid, *(one for child in children for one in descendants(int(child)))]


def largest_memory(pid):
    """Peak memory (MB) so far of the largest process among a process and its descendants."""
    peaks = [0]
    for one in descendants(pid):
        try:
            peaks += [int(kB) for kB in re.findall(r'^VmHWM:\s*(\d+) kB', open(f'/proc/{one}/status').read(), re.M)]
        except OSError:
            pass
    return max(peaks) * 1024 / 1e6


def execute(words, log):
    """Runs a command. Returns its output, the number of cores used by other processes, and its peak memory in MB (with ranks: of the largest)."""
    began, busy, memory = time.time(), busy_seconds(), 0
    with open(log, 'w') as out:
        process = subprocess.Popen(['timeout', str(LONGEST), *map(str, words)], stdin=subprocess.DEVNULL, stdout=out,
                                   stderr=subprocess.STDOUT, env=dict(os.environ, OMP_NUM_THREADS='1'), cwd=log.parent)
        # the maximum that the system reports at the end includes the memory of this script, from which the process was forked
        while True:
            ended, status, usage = os.wait4(process.pid, os.WNOHANG)
            if ended:
                break
            memory = max(memory, largest_memory(process.pid))
            time.sleep(0.05)
        process.returncode = os.waitstatus_to_exitcode(status)
    own = usage.ru_utime + usage.ru_stime
    load = max(0, busy_seconds() - busy - own) / (time.time() - began)
    text = log.read_text(errors='replace')
    if process.returncode != 0:
        raise RuntimeError(f'{" ".join(map(str, words))}: exit code {process.returncode}\n{text[-800:]}')
    return text, load, memory


@functools.cache
def here():
    """Machine and version that are measured (+: with uncommitted changes). Times are comparable on one machine only."""
    about = open('/proc/cpuinfo').read()
    field = lambda name: (re.findall(rf'^{name}\s*: (.*)$', about, re.M) or ['unknown'])[0]
    return {'machine': f'{field("model name")}, family {field("cpu family")}, model {field("model")}, {os.cpu_count()} cores', 'commit': commit()}


def read_rows(path):
    return list(csv.DictReader(open(path))) if path.exists() else []


def of_here(rows):
    return [row for row in rows if here().items() <= row.items()]


def of_last(rows):
    """Rows with the same machine and version as the last row."""
    version = lambda row: (row.get('machine'), row.get('commit'))
    return [row for row in rows if version(row) == version(rows[-1])]


def append(path, columns, row):
    """Adds a line to a CSV file, with machine and version. New columns are added to an older file and stay empty in its lines."""
    columns = [*columns, *here()]
    rows = [*read_rows(path), {**row, **here()}]
    write(path, [columns, *([row.get(name, '') for name in columns] for row in rows)])


def measured(text, check, steps):
    """Results in the output of a run: key=value, or the tables of LAMMPS and LIGGGHTS."""
    line = re.findall(r'^code=.*$', text, re.M)
    if line:
        return {name: value for name, value in (word.split('=', 1) for word in line[-1].split())}
    spheres, *numbers = re.findall(rf'^ *{check} +(\d+) +(\S+) +(\S+) +(\S+) *$', text, re.M)[0]
    loops = re.findall(r'Loop time of (\S+) on \d+ procs for (\d+) steps', text)
    wall, timed = loops[-1]
    if int(timed) != steps:
        raise RuntimeError(f'expected {steps} timed steps, found {timed}')
    return dict(zip(('coordination', 'kinetic_energy_J', 'wall_force_over_weight'), numbers), spheres=spheres, wall_s=wall,
                check_wall_s=loops[0][0])
