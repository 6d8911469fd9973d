"""The table of a campaign: one process adds to it at a time, and each row says of which commit and with which options of the campaign it was made."""
import atexit
import collections
import csv
import fcntl
import functools
import os
import shlex
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
ORIGIN = ('commit', 'made_with')  # last columns of every table; empty in rows of which it was not recorded
UNKNOWN = 'not recorded'
held = {}  # open lock files by their paths


def add_option(parser):
    parser.add_argument('--any-commit', action='store_true', help='Use rows and results of other commits, too. Without this a campaign adds nothing to a table '
                        'with rows of another commit, and goes on from no run that another commit has begun; it only prints a table that is complete. Rows '
                        'that were made with other options of the campaign are never used.')


@functools.cache
def commit():
    """The commit of the project (+: with uncommitted changes of anything but tables of results)."""
    def git(*words):
        return subprocess.run(['git', '-C', ROOT, *words], capture_output=True, text=True, check=True).stdout.strip()
    try:
        changed = git('status', '--porcelain', '--untracked-files=no', '--', '.', ':!tests/performance/results')
        return git('rev-parse', '--short', 'HEAD') + ('+' if changed else '')
    except (OSError, subprocess.CalledProcessError):
        return 'unknown'


def hold(table):
    """Locks a table until this process ends. Ends the campaign if another process has it: both would add to what they read at their beginning,
    and the rows of one of them would be lost. The lock is a file beside the table, because the table itself is replaced when rows are added."""
    lock = Path(table).resolve().with_name(f'.{Path(table).name}.lock')
    if lock in held:
        return
    lock.parent.mkdir(parents=True, exist_ok=True)
    while True:
        file = open(lock, 'a+')
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            file.seek(0)
            raise SystemExit(f'{table}: expected no other campaign at this table, found process {file.read().strip() or "unknown"}: wait for its end, or name '
                             'another table with --csv')
        if lock.exists() and os.path.samestat(os.fstat(file.fileno()), os.stat(lock)):
            break  # else its last holder has removed it meanwhile
        file.close()
    file.truncate(0)
    file.write(f'{os.getpid()} ({shlex.join(sys.argv)})\n')
    file.flush()
    held[lock] = file
    atexit.register(lambda owner=os.getpid(): owner == os.getpid() and lock.unlink(missing_ok=True))


def made_with(args, settings):
    """Text of the options of a campaign that change its numbers; `settings` are their names in `args`."""
    return ' '.join(f'--{name.replace("_", "-")} {getattr(args, name)}' for name in settings)


def lines_of(table):
    """The cells of a table, a list for each line. Ends the campaign if it is cut off or damaged: the runs of lost lines would be missing."""
    if not table.exists():
        return []
    try:
        text = table.read_text()
    except (OSError, UnicodeDecodeError) as error:
        raise SystemExit(f'{table}: expected a table of results: {error}')
    lines = list(csv.reader(text.splitlines()))
    for number, cells in enumerate(lines, 1):
        if len(cells) != len(lines[0]):
            raise SystemExit(f'{table}:{number}: expected {len(lines[0])} columns, found {len(cells)}')
    if not text.endswith('\n'):
        raise SystemExit(f'{table}:{len(lines)}: expected complete lines, found the last one cut off')
    return with_origin(lines)


def with_origin(lines):
    """The same with the columns of the origin, empty if the table is older than these."""
    if not lines or tuple(lines[0][-2:]) == ORIGIN:
        return lines
    return [[*lines[0], *ORIGIN], *([*cells, '', ''] for cells in lines[1:])]


class Row(dict):
    """A line of a table by the names of its columns."""
    def __init__(self, table, names, cells):
        super().__init__(zip(names, cells))
        self.table = table

    def __missing__(self, name):
        raise SystemExit(f'{self.table}:1: expected a column {name}, found {", ".join(self)}')


def rows_with_cells(table, lines):
    """The lines of a table below its head, each as a dictionary and as cells."""
    return [(Row(table, lines[0], line), line) for line in lines[1:]]


def write(table, lines):
    """Replaces a table at once, so that a campaign that is killed leaves whole runs only."""
    table.parent.mkdir(parents=True, exist_ok=True)
    unfinished = table.with_name(f'{table.name}.{os.getpid()}.tmp')
    with open(unfinished, 'w', newline='') as out:
        csv.writer(out, lineterminator='\n').writerows(lines)
    os.replace(unfinished, table)


def add(table, head, rows, options):
    """Adds rows to a table that this process holds. `options`: of the campaign (made_with)."""
    hold(table)
    lines = lines_of(table) or [[*head, *ORIGIN]]
    if lines[0] != [*head, *ORIGIN]:
        raise SystemExit(f'{table}:1: expected the columns {", ".join(head)}, found {", ".join(lines[0])}')
    write(table, [*lines, *([*(str(cell) for cell in row), commit(), options] for row in rows)])


def replace(table, head, rows, options):
    """Replaces all rows of a table."""
    hold(table)
    write(table, [[*head, *ORIGIN], *([*row, commit(), options] for row in rows)])


def require_origin(table, rows, options, is_complete, any_commit):
    """Ends the campaign if `rows` are not those that it would make: other options always, another commit unless nothing is left to do or
    `any_commit` is set. Prints of which commits they are if not all are of this one."""
    other = collections.Counter(row['made_with'] for row in rows if row['commit'] and row['made_with'] != options)
    if other:
        raise SystemExit(f'{table}: expected rows that were made with {options or "no options"}, found {sum(other.values())} with '
                         f'{", ".join(text or "no options" for text in other)}: name another table with --csv')
    commits = collections.Counter(row['commit'] or UNKNOWN for row in rows)
    if set(commits) <= {commit()}:
        return
    found = ', '.join(f'{name} ({count} rows)' for name, count in commits.items())
    if not is_complete and not any_commit:
        raise SystemExit(f'{table}: expected rows of commit {commit()}, found {found}: name another table with --csv, or add to this one with --any-commit')
    print(f'{table}: commits: {found}', flush=True)
