"""BRIS from Python: read what runs wrote, and build, step and read simulations.

All numbers have SI units. Scene and Simulation are documented by help(bris.Scene) and help(bris.Simulation)."""
from ._bris import BusyError, InputError, OutputError, Scene, Simulation, SimulationError, laws, read_checkpoint, version
from .files import RunFile, open_run, read_csv, read_summary

__all__ = ['BusyError', 'InputError', 'OutputError', 'RunFile', 'Scene', 'Simulation', 'SimulationError', 'laws', 'open_run',
           'read_checkpoint', 'read_csv', 'read_summary', 'version']
