"""Files of BRIS as NumPy arrays."""
import csv
import json
import re
from pathlib import Path

import numpy as np

from ._bris import InputError, OutputError

DAMAGE = (KeyError, OSError, RuntimeError, TypeError, IndexError, ValueError)  # what h5py raises where something is missing


def _open(path):
    """The HDF5 file, or an error in words of this project."""
    try:
        import h5py
    except ImportError:
        raise ImportError('open_run: expected h5py, found none: apt install python3-h5py, or pip install h5py') from None
    if not Path(path).is_file():
        raise OutputError(f'{path}: expected a run file, found no such file')
    try:
        return h5py.File(path, 'r')
    except BlockingIOError:
        raise OutputError(f'{path}: expected a run file that is complete, found one into which a run is writing') from None
    except OSError:
        raise OutputError(f'{path}: expected a run file, found a file that is damaged or is not HDF5') from None


class RunFile:
    """A run file NAME.vtkhdf: frames, series and settings. Use it in a with statement, or call close().

    times   times of the frames, s
    fields  names of the arrays of a frame, a row for each point; orientation is x, y, z, w
    cell_fields  names of those with a row for each cell
    units   unit of each array by its name; empty: none
    meta    settings and versions of the run
    """

    def __init__(self, path):
        self._path, self._file = path, _open(path)
        try:
            self._read_contents()
        except DAMAGE:
            self.close()
            raise InputError(f'{path}: expected a run file, found an HDF5 file without the frames of one') from None

    def _read_contents(self):
        self._grid = self._file['VTKHDF']
        self.times = self._grid['Steps/Values'][:]
        self.fields = sorted(self._grid['PointData'])
        self.cell_fields = sorted(self._grid.get('CellData', ()))
        self.units = {name: _text(self._grid[kind][name].attrs.get('unit', ''))
                      for kind, names in (('PointData', self.fields), ('CellData', self.cell_fields)) for name in names}
        self.meta = {key: _text(value) for key, value in self._file['meta'].attrs.items()} if 'meta' in self._file else {}

    def __len__(self):
        return len(self.times)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def close(self):
        self._file.close()

    def _require_open(self):
        if not self._file:
            raise InputError(f'{self._path}: expected an open run file, found it closed')

    def _frame_number(self, k):
        self._require_open()
        if not -len(self) <= k < len(self):
            raise IndexError(f'{self._path}: expected a frame from {-len(self)} to {len(self) - 1}, found {k}')
        return k % len(self)

    def _reading(self, read, *arguments):
        """What `read` returns; a file that lacks a part of what it announces is refused."""
        try:
            return read(*arguments)
        except DAMAGE as error:
            if isinstance(error, InputError):
                raise
            raise InputError(f'{self._path}: expected a whole run file, found one that is damaged') from None

    def frame(self, k):
        """The arrays of frame k (negative: from the last one) by their names, and `position` (m), a row for each rock."""
        return self._reading(self._arrays_of_points, self._frame_number(k))

    def cells(self, k):
        """The cells of frame k of a file with contacts or surfaces: `corners` (cells x corners), the rows of their points in
        `frame(k)`, and the arrays with a row for each cell by their names."""
        return self._reading(self._arrays_of_cells, self._frame_number(k))

    def series(self, name):
        """The time series of that name, an array for each column. Names: see `series_names`."""
        if name not in self.series_names:
            raise InputError(f'{self._path}: expected a series among {", ".join(self.series_names) or "none"}, found {name}')
        return self._reading(self._columns_of, name)

    @property
    def series_names(self):
        self._require_open()
        return sorted(self._file['tracks']) if 'tracks' in self._file else []

    def _arrays_of_points(self, k):
        parts, steps = self._grid['NumberOfPoints'], self._grid['Steps']
        points = int(parts[int(steps['PartOffsets'][k])])
        first = int(steps['PointOffsets'][k])
        arrays = {'position': self._grid['Points'][first:first + points]}
        for name in self.fields:
            start = int(steps['PointDataOffsets'][name][k])
            arrays[name] = self._grid['PointData'][name][start:start + points]
        if 'orientation' in arrays:  # files have w, x, y, z, as ParaView reads them
            arrays['orientation'] = np.roll(arrays['orientation'], -1, axis=1)
        rocks = arrays['id'] >= 0 if 'id' in arrays else slice(None)  # corners of the membrane have the id -1
        return {name: values[rocks] for name, values in arrays.items()}

    def _arrays_of_cells(self, k):
        steps = self._grid['Steps']
        part, first = int(steps['PartOffsets'][k]), int(steps['CellOffsets'][k, 0])
        count, numbers = int(self._grid['NumberOfCells'][part]), int(self._grid['NumberOfConnectivityIds'][part])
        start = int(steps['ConnectivityIdOffsets'][k, 0])
        if count and len(set(self._grid['Types'][first:first + count])) > 1:
            raise InputError(f'{self._path}: expected cells of one kind, found several')
        arrays = {'corners': self._grid['Connectivity'][start:start + numbers].reshape(count, -1 if count else 0)}
        for name in self.cell_fields:
            start = int(steps['CellDataOffsets'][name][k])
            arrays[name] = self._grid['CellData'][name][start:start + count]
        return arrays

    def _columns_of(self, name):
        return {column: values[:] for column, values in self._file['tracks'][name].items()}


def open_run(path):
    """Opens a run file, or the only one of a folder of results; files of --write are opened by their paths."""
    path = Path(path)
    if path.is_dir():
        found = sorted(file for file in path.glob('*.vtkhdf') if not re.search('_(surfaces|contacts)($|_from_)', file.stem))
        if len(found) != 1:
            raise InputError(f'{path}: expected one run file, found {len(found)}')
        path = found[0]
    return RunFile(path)


def read_summary(path):
    """The settings and results of summary.json, by their keys; `path` is the file or its folder."""
    path = Path(path)
    file = path / 'summary.json' if path.is_dir() else path
    try:
        return json.loads(file.read_text())
    except json.JSONDecodeError as error:
        raise InputError(f'{file}: expected a complete JSON file: {error}') from None


def read_csv(path):
    """The columns of a CSV file with a heading, by their names: whole numbers, numbers (NaN where one is missing) or text; lines that
    begin with # are comments."""
    with open(path, newline='', encoding='utf-8-sig') as file:
        lines = [cells for cells in csv.reader(line for line in file if line.strip() and not line.startswith('#'))]
    if not lines:
        raise InputError(f'{path}: expected a heading, found an empty file')
    for cells in lines[1:]:
        if len(cells) != len(lines[0]):
            raise InputError(f'{path}: expected {len(lines[0])} columns, found {len(cells)} in {",".join(cells)}')
    return {name.strip(): _column([cells[k].strip() for cells in lines[1:]]) for k, name in enumerate(lines[0])}


def _column(cells):
    for kind in (int, lambda cell: float(cell) if cell not in ('', '-') else float('nan')):
        try:
            return np.array([kind(cell) for cell in cells], dtype=None if cells else float)
        except ValueError:
            pass
    return np.array(cells)


def _text(value):
    return value.decode() if isinstance(value, bytes) else value
