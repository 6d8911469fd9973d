#!/usr/bin/env python3
"""consumer_test.py BUILD FOLDER: BRIS in the program of somebody else, installed and as a subdirectory: the same lanes and bits as
in its own build, and no link with a flag that changes the lanes. BUILD is the folder in which everything was built."""
import re
import shutil
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
BUILD, FOLDER = (Path(word).resolve() for word in sys.argv[1:])


def run(*command):
    done = subprocess.run([str(word) for word in command], text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    return done.returncode, done.stdout


def must(*command):
    code, text = run(*command)
    if code != 0:
        sys.exit(f'{" ".join(map(str, command))}: expected exit code 0, found {code}\n{text}')
    return text


def configure(name, *options):
    folder = FOLDER / name
    must('cmake', '-S', HERE, '-B', folder, '-G', 'Ninja', *options)
    return folder


def answer(folder):
    must('cmake', '--build', folder, '-j', 2)
    return must(folder / 'consumer').strip()


shutil.rmtree(FOLDER, ignore_errors=True)
expected = must(BUILD / 'bin' / 'consumer').strip()
arch = re.search(r'^BRIS_ARCH:STRING=(.*)$', (BUILD / 'CMakeCache.txt').read_text(), re.MULTILINE).group(1)
must('cmake', '--install', BUILD, '--prefix', FOLDER / 'installed', '--component', 'development')
prefix = f'-DCMAKE_PREFIX_PATH={FOLDER / "installed"}'

found = answer(configure('by_package', prefix))
assert found == expected, f'find_package: expected {expected}, found {found}'

wrong = '-mno-avx512f' if expected.startswith('8') else '-mavx512f'
folder = configure('wrong_flag', prefix, f'-DOWN_FLAG={wrong}')
code, text = run('cmake', '--build', folder)
assert code != 0 and 'undefined reference' in text and re.search('bris::lanes_[48]::World', text), \
    f'{wrong}: expected a link that fails by the lanes in the name of World, found\n{text}'

code, text = run('cmake', '--build', configure('fast_math', prefix, '-DOWN_FLAG=-ffast-math'))
assert code != 0 and 'compile flags of bris::engine' in text, f'-ffast-math: expected a refusal, found\n{text}'

found = answer(configure('by_subdirectory', f'-DBRIS_SOURCE={HERE.parents[1]}', f'-DBRIS_ARCH={arch}'))
assert found == expected, f'add_subdirectory: expected {expected}, found {found}'
print(f'installed, as a subdirectory and in its own build: {expected}')
