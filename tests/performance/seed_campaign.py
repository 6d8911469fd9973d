"""What campaigns over seeds share: a table of numbers of each seed and pressure, which is added to and never run twice."""
import argparse
import csv
import math
import statistics
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PRESSURES = ('55', '110', '165')  # kPa
STUDENT = (12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262)  # 97.5 %, by degrees of freedom


def half_width(numbers):
    """Of the interval of 95 % of their mean (Student's t); 0 for one."""
    if len(numbers) < 2:
        return 0
    return (STUDENT[len(numbers) - 2] if len(numbers) < 11 else 1.96) * statistics.stdev(numbers) / math.sqrt(len(numbers))


def interval(numbers):
    """Their geometric mean, with that interval."""
    logarithms = [math.log(x) for x in numbers]
    mean, half = statistics.mean(logarithms), half_width(logarithms)
    return f'{math.exp(mean):.2f} ({math.exp(mean - half):.2f}-{math.exp(mean + half):.2f})' if half else f'{math.exp(mean):.2f}'


def parser(doc, seeds, table):
    """`table`: name of the CSV file among the results. Runs go to a folder of the campaign's name."""
    arguments = argparse.ArgumentParser(description=doc, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument('--seeds', type=lambda text: [int(word) for word in text.split(',')], default=list(seeds))
    arguments.add_argument('--threads', type=int, default=2)
    arguments.add_argument('--bin', type=Path, default=ROOT / 'build' / 'bin')
    arguments.add_argument('--work', type=Path, default=ROOT / 'results' / Path(sys.argv[0]).name)
    arguments.add_argument('--csv', type=Path, default=ROOT / 'tests' / 'performance' / 'results' / table)
    return arguments


def options(doc, seeds, table):
    return parser(doc, seeds, table).parse_args()


def scenario(args, name, words, out):
    """Runs a scenario; what it prints goes to OUT.log."""
    out.parent.mkdir(parents=True, exist_ok=True)
    with open(f'{out}.log', 'w') as log:
        command = [args.bin / name, '--quiet', '--threads', args.threads, *words, '--out', out]
        subprocess.run([str(word) for word in command], check=True, stdout=log, stderr=log)


def rows_of(args):
    return list(csv.DictReader(open(args.csv))) if args.csv.exists() else []


def add(args, seed, numbers):
    """`numbers`: by (pressure, quantity)."""
    fresh = not args.csv.exists()
    with open(args.csv, 'a') as out:
        if fresh:
            out.write('seed,pressure_kPa,quantity,value\n')
        out.writelines(f'{seed},{pressure},{quantity},{value:.6g}\n' for (pressure, quantity), value in numbers.items())


def run(args, numbers_of_seed, report):
    done = {int(row['seed']) for row in rows_of(args)}
    for seed in args.seeds:
        if seed not in done:
            add(args, seed, numbers_of_seed(args, seed))
            print(f'seed {seed} done', flush=True)
    report(rows_of(args))
