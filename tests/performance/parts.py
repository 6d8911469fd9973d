"""Parts of a campaign. A campaign is a list of independent runs; with --part K/N it does every N-th of them, from the K-th on, and writes a
table of its own beside the campaign's, NAME.part_K_of_N.csv. Parts may run at once, on one machine or several, and a part that was killed
goes on where it was when it is started again. --merge collects the tables of all parts, in the order of a campaign without parts:

    for k in 1 2 3 4; do tests/performance/smart_campaign --part $k/4 & done; wait
    tests/performance/smart_campaign --merge

A table belongs to one process at a time, which locks it; a second one ends with the number of the first.

The same with GNU parallel: parallel tests/performance/smart_campaign --part {}/4 ::: 1 2 3 4; in a Slurm array: --part $SLURM_ARRAY_TASK_ID/4.
Under mpirun or srun each process does the part of its rank: mpirun -n 4 tests/performance/smart_campaign.
"""
import argparse
import collections
import os
import re

import tables
from tables import lines_of, rows_with_cells, write


def part(text):
    found = re.fullmatch(r'(\d+)/(\d+)', text)
    if not found or not 1 <= int(found[1]) <= int(found[2]):
        raise argparse.ArgumentTypeError(f'expected K/N with K from 1 to N, found "{text}"')
    return int(found[1]), int(found[2])


def of_launcher():
    """(K, N) of a process that mpirun or srun has started with others, else None. What tells MPI of this is taken from the environment,
    since the programs that the campaign starts are no ranks of one world."""
    found = None
    for size, rank in (('OMPI_COMM_WORLD_SIZE', 'OMPI_COMM_WORLD_RANK'), ('PMI_SIZE', 'PMI_RANK'), ('SLURM_STEP_NUM_TASKS', 'SLURM_PROCID')):
        if found is None and int(os.environ.get(size, 1)) > 1:
            found = int(os.environ[rank]) + 1, int(os.environ[size])
    for name in [n for n in os.environ if n.startswith(('OMPI_', 'PMI_', 'PMIX_'))]:
        del os.environ[name]
    return found


def add_options(parser):
    parser.add_argument('--part', type=part, default=of_launcher(),
                        help='K/N: do every N-th run from the K-th on, with a table of its own. Default: all runs; under mpirun the part of the rank.')
    parser.add_argument('--merge', action='store_true', help='Run nothing: merge the tables of all parts into the table of the campaign.')
    tables.add_option(parser)


def mine(args, runs):
    """The runs of this part; none with --merge."""
    if args.merge:
        return []
    return [run for k, run in enumerate(runs) if args.part is None or k % args.part[1] == args.part[0] - 1]


def own_table(args, table):
    """The table that this part adds to."""
    return table.with_name(f'{table.stem}.part_{args.part[0]}_of_{args.part[1]}.csv') if args.part else table


def rows_of(args, table):
    """Rows of the campaign's table and of that of this part, as dictionaries."""
    names = dict.fromkeys([table, own_table(args, table)])
    return [row for name in names for row, _ in rows_with_cells(name, lines_of(name))]


def add(args, table, head, rows):
    """Adds all rows of a run to the table of this part."""
    tables.add(own_table(args, table), head, rows, args.made_with)


def begin(args, table, runs, run_of, case_of=None, settings=()):
    """To be called before anything is run. Locks the table of this part, and ends the campaign if it has rows that were made by another
    commit or with other `settings`, names of the options that change numbers. With --merge, merges the tables of all parts into the
    campaign's. `run_of(row)` is the run of a row, which sorts the rows in the order of `runs`; runs that are not in this list come first, as
    they are. `case_of(row)` is the case within a run that was added at once (default: the whole run); a case that several tables have is taken
    from the first."""
    args.made_with = tables.made_with(args, settings)
    tables.hold(own_table(args, table))
    if args.merge:
        return merge(args, table, runs, run_of, case_of or run_of)
    rows = rows_of(args, table)
    done = {run_of(row) for row in rows}
    tables.require_origin(table, rows, args.made_with, all(run in done for run in mine(args, runs)), args.any_commit)


def merge(args, table, runs, run_of, case_of):
    order = {run: k for k, run in enumerate(runs)}
    pattern = re.compile(re.escape(table.stem) + r'\.part_\d+_of_\d+\.csv')
    parts = sorted(path for path in table.parent.glob('*.csv') if pattern.fullmatch(path.name))
    for path in parts:
        tables.hold(path)
    head, merged, seen, of_parts = None, [], {}, []
    for name in [table, *parts]:
        lines = lines_of(name)
        if not lines:
            continue
        if head not in (None, lines[0]):
            raise SystemExit(f'{name}:1: expected the columns {", ".join(head)} as in the other tables, found {", ".join(lines[0])}')
        head = lines[0]
        rows = rows_with_cells(name, lines)
        of_parts += [row for row, _ in rows if name in parts]
        counts = collections.Counter(case_of(row) for row, _ in rows)
        for case, count in counts.items():
            if case in seen and seen[case][1] != count:
                raise SystemExit(f'{name}: expected {seen[case][1]} lines of run {case} as in {seen[case][0]}, found {count}: one of them is cut off')
        merged += [(row, line) for row, line in rows if case_of(row) not in seen]
        for case, count in counts.items():
            seen.setdefault(case, (name, count))
    tables.require_origin(table, [row for row, _ in merged], args.made_with, not of_parts, args.any_commit)
    if head:
        write(table, [head, *(line for _, line in sorted(merged, key=lambda entry: order.get(run_of(entry[0]), -1)))])
    for path in parts:
        path.unlink()
    print(f'{table}: merged from {len(parts)} tables of parts, {len(merged)} rows')
