"""Recipe: force chains. A line joins the centres of each pair of touching spheres; its width grows with the normal force."""
import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import LineCollection

import bris
from own_servo import loose_bed


def chains(simulation):
    """Ends of the branch vectors of pairs of spheres (pairs x 2 x 3, m) and their normal forces (N)."""
    contacts, state = simulation.contacts(), simulation.state()
    row = np.empty(state['bodies/id'].max() + 1, int)
    row[state['bodies/id']] = np.arange(len(state['bodies/id']))
    between = np.array(contacts['kind']) == 'sphere'
    ends = [state['bodies/position'][row[contacts[side][between]]] for side in ('owner', 'partner')]
    return np.stack(ends, axis=1), contacts['normal_force'][between]


def main(out):
    simulation, plate, _ = loose_bed()
    simulation.drive(plate, (0, 0, -0.2))
    simulation.advance(15000)
    lines, force = chains(simulation)
    print(f'{len(force)} contacts between spheres, mean normal force {force.mean():.3g} N, largest {force.max():.3g} N')
    assert len(force) > 0 and np.isfinite(force).all()
    figure, axes = plt.subplots(figsize=(5, 6))
    axes.add_collection(LineCollection(lines[:, :, (0, 2)], linewidths=1.5 * force / force.mean(), alpha=0.6))
    axes.set(xlabel='x (m)', ylabel='z (m)', aspect='equal')
    axes.autoscale()
    figure.savefig(out / 'force_chains.png', dpi=150)


if __name__ == '__main__':
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    main(folder)
