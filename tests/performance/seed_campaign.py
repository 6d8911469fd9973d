"""Common parts of campaigns over seeds: a table with the numbers of each seed and pressure. Seeds that are in it are not run again."""
import argparse
import math
import signal
import statistics
import sys
from pathlib import Path

import parts
from run_folders import once, scenario  # noqa: F401

ROOT = Path(__file__).resolve().parents[2]
PRESSURES = ('55', '110', '165')  # kPa
STUDENT = (12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262)  # 97.5 %, by degrees of freedom


def student(freedom):
    """97.5 % quantile of Student's t to 1e-3; from ten degrees of freedom on by its series in their inverse (Abramowitz and Stegun 26.7.5)."""
    if freedom <= len(STUDENT):
        return STUDENT[freedom - 1]
    z = statistics.NormalDist().inv_cdf(0.975)
    terms = ((z ** 3 + z) / 4, (5 * z ** 5 + 16 * z ** 3 + 3 * z) / 96, (3 * z ** 7 + 19 * z ** 5 + 17 * z ** 3 - 15 * z) / 384)
    return z + sum(term / freedom ** k for k, term in enumerate(terms, 1))


def half_width(numbers):
    """Half width of the 95 % confidence interval of the mean (Student's t). 0 for a single number."""
    return student(len(numbers) - 1) * statistics.stdev(numbers) / math.sqrt(len(numbers)) if len(numbers) > 1 else 0


def interval(numbers):
    """Text of the geometric mean with its 95 % confidence interval."""
    logarithms = [math.log(x) for x in numbers]
    mean, half = statistics.mean(logarithms), half_width(logarithms)
    return f'{math.exp(mean):.2f} ({math.exp(mean - half):.2f}-{math.exp(mean + half):.2f})' if half else f'{math.exp(mean):.2f}'


def mean_text(numbers, digits=2):
    """Text of the mean and the half width of its 95 % confidence interval."""
    return f'{statistics.mean(numbers):.{digits}f} +- {half_width(numbers):.{digits}f}'


def stop(number, _):
    sys.exit(128 + number)  # ends a scenario that runs, too


def parser(doc, seeds, table):
    """Argument parser of a campaign, which a signal ends together with its scenario from then on. `table` is the name of the CSV file in the
    results folder. Runs go to a folder with the campaign's name."""
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, stop)
    arguments = argparse.ArgumentParser(description=doc, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument('--seeds', type=lambda text: [int(word) for word in text.split(',')], default=list(seeds), help='Seeds, separated by commas.')
    arguments.add_argument('--threads', type=int, default=2, help='Number of threads of a run.')
    arguments.add_argument('--bin', type=Path, default=ROOT / 'build' / 'bin', help='Folder of the executables.')
    arguments.add_argument('--work', type=Path, default=ROOT / 'results' / Path(sys.argv[0]).name, help='Folder of the runs.')
    parts.add_options(arguments)
    arguments.add_argument('--csv', type=Path, default=ROOT / 'tests' / 'performance' / 'results' / table, help='Table of the results.')
    return arguments


def options(doc, seeds, table):
    return parser(doc, seeds, table).parse_args()


def rows_of(args):
    return parts.rows_of(args, args.csv)


def add(args, seed, numbers):
    """Adds the numbers of a seed to the table. `numbers` is a dictionary by (pressure, quantity)."""
    parts.add(args, args.csv, ('seed', 'pressure_kPa', 'quantity', 'value'),
              [(seed, pressure, quantity, f'{value:.6g}') for (pressure, quantity), value in numbers.items()])


def run_states(args, runs, columns, numbers_of, settings=()):
    """Does the runs of this part that are not in the table yet. A run is a tuple of a seed and names, the first `columns` of the table;
    `numbers_of(args, *run)` gives its rows. `settings`: options that change numbers (parts.begin)."""
    names = columns[1:len(runs[0])]
    run_of = lambda row: (int(row['seed']), *(row[name] for name in names))  # noqa: E731
    parts.begin(args, args.csv, runs, run_of, settings=settings)
    done = {run_of(row) for row in rows_of(args)}
    for seed, *state in parts.mine(args, runs):
        if (seed, *state) not in done:
            parts.add(args, args.csv, columns, numbers_of(args, seed, *state))
            print(f'seed {seed} {" ".join(state)} done', flush=True)


def run(args, numbers_of_seed, report, settings=()):
    parts.begin(args, args.csv, args.seeds, lambda row: int(row['seed']), settings=settings)
    done = {int(row['seed']) for row in rows_of(args)}
    for seed in parts.mine(args, args.seeds):
        if seed not in done and (numbers := numbers_of_seed(args, seed)):
            add(args, seed, numbers)
            print(f'seed {seed} done', flush=True)
    if args.part is None:
        report(rows_of(args))
