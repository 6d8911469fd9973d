"""BRIS from Python: run scenarios, read what runs wrote, and build, step and read simulations.

All numbers have SI units. Quaternions are x, y, z, w, as in SciPy, and turn from a body's axes to the world's. Scene and Simulation are documented by help(bris.Scene) and help(bris.Simulation)."""
from ._bris import BusyError, InputError, OutputError, Scene, Simulation, SimulationError, laws, read_checkpoint, version
from .files import RunFile, open_run, read_csv, read_summary
from .running import Results, run

__all__ = ['BusyError', 'InputError', 'OutputError', 'Results', 'RunFile', 'Scene', 'Simulation', 'SimulationError', 'laws', 'open_run',
           'read_checkpoint', 'read_csv', 'read_summary', 'run', 'version']
