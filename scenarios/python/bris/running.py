"""Runs of scenarios, and what they wrote."""
import os
import shutil
import signal
import subprocess
import time
import warnings
from functools import cached_property
from pathlib import Path

import numpy as np

from ._bris import InputError, OutputError, SimulationError
from .files import open_run, read_csv, read_summary

ERRORS = {2: InputError, 3: SimulationError, 4: OutputError}  # by the exit code of a program
NOT_JUDGED, INTERRUPTED = 5, 130
NO_RUN = {'explain', 'help', 'version', 'list'}  # options that print something and run nothing


class Results:
    """What a run wrote into its folder.

    folder   the folder
    summary  settings and results, by the keys of summary.json
    text     what the run printed at its end
    tables   names of the CSV files without their ending; results['55kPa/curve'] has the columns of one as NumPy arrays, by name
    report   the page that shows it all, report.html
    """

    def __init__(self, folder, text, since):
        self.folder, self.text = Path(folder), text
        self.report = self.folder / 'report.html'
        # not those of an earlier run; a clock of a file system may be a tick behind
        self.tables = sorted(str(file.relative_to(self.folder).with_suffix('')) for file in self.folder.rglob('*.csv')
                             if file.stat().st_mtime >= since - 1)

    @cached_property
    def summary(self):
        return read_summary(self.folder)

    def __getitem__(self, name):
        if name not in self.tables:
            raise KeyError(f'results: expected one of {", ".join(self.tables)}, found {name}')
        return read_csv(self.folder / f'{name}.csv')

    def open_run(self, part=''):
        """The run file (bris.open_run), of a part, as '55kPa', if there are several."""
        return open_run(self.folder / part)

    def __repr__(self):
        return f'{self.text}tables: {", ".join(self.tables)}'


def run(scenario, **options):
    """Runs a scenario to its end and returns its Results: bris.run('triaxial', confining_pressure=[55e3, 110e3], threads=2).

    Options are those of --help with underscores, numbers in SI units; None: the default. Without `out` the results are in
    results/SCENARIO in the current folder. Raises InputError, SimulationError or OutputError with the message of the program. An
    interrupt (Ctrl-C) lets the program save its state, if it can be resumed."""
    options = {'quiet': True, **options}
    for name in NO_RUN & options.keys():
        raise InputError(f'run: expected options of a run, found {name}')
    words = [str(_command()), 'run', str(scenario)]
    words += [f'--{name.replace("_", "-")}={_text(value)}' for name, value in options.items() if value is not None]
    began = time.time()
    code, text, errors = _outcome_of(words)
    complaint = errors.strip().rpartition('\n')[2]
    if code == NOT_JUDGED:
        warnings.warn(complaint, stacklevel=2)
    elif code == INTERRUPTED:
        raise KeyboardInterrupt(complaint)
    elif code != 0:
        raise ERRORS.get(code, RuntimeError)(complaint or f'{scenario}: expected an end, found one by signal {-code}')
    return Results(options.get('out') or Path('results') / scenario, text, began)


def _outcome_of(words):
    """Exit code, output and messages. Of a process group of its own: a notebook's interrupt does not reach it but through us."""
    with subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True) as program:
        try:
            out, errors = program.communicate()
        except BaseException:
            program.send_signal(signal.SIGINT)
            program.communicate()
            raise
    return program.returncode, out, errors


def _command():
    """The program bris: in the folder BRIS_BINARIES, of the wheel or the build that this module belongs to, or along PATH."""
    here = Path(__file__).absolute()
    folders = [os.environ.get('BRIS_BINARIES'), here.parent / 'bin', here.parents[2] / 'bin']
    found = [Path(folder) / 'bris' for folder in folders if folder and (Path(folder) / 'bris').is_file()]
    if not found and not (found := [shutil.which('bris')])[0]:
        raise OutputError('run: expected the program bris beside this module or along PATH, found none: scenarios/build')
    return found[0]


def _text(value):
    """An option as a command line gives it."""
    if isinstance(value, (bool, np.bool_)):
        return 'true' if value else 'false'
    if isinstance(value, (list, tuple, np.ndarray)):
        return ','.join(_text(one) for one in value)
    return repr(float(value)) if isinstance(value, (float, np.floating)) else str(value)
