"""Recipe: a sweep. The restitution of a bouncing sphere is varied, one process for each core; the table goes into a CSV."""
import csv
import multiprocessing
import sys
from pathlib import Path

from own_scenario import HEIGHT, heights, rebound

RESTITUTIONS = (0.3, 0.5, 0.7, 0.9)


def height_of(restitution):
    return rebound(*heights(restitution))


def main(out):
    with multiprocessing.Pool() as pool:
        found = pool.map(height_of, RESTITUTIONS)
    with open(out / 'sweep.csv', 'w', newline='') as table:
        rows = csv.writer(table)
        rows.writerow(('restitution', 'rebound_height_m', 'exact_m'))
        rows.writerows((e, f'{h:.6g}', f'{e * e * HEIGHT:.6g}') for e, h in zip(RESTITUTIONS, found))
    print((out / 'sweep.csv').read_text(), end='')
    assert all(abs(h / (e * e * HEIGHT) - 1) < 1e-2 for e, h in zip(RESTITUTIONS, found))


if __name__ == '__main__':
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    main(folder)
