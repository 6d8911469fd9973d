"""Recipe: a scenario of your own. A sphere falls onto a plane and rebounds to the height that the coefficient of
restitution predicts, e^2 h."""
import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import bris

RADIUS, HEIGHT, STEP = 0.01, 0.1, 2e-6  # m, m, s


def bouncing_sphere(restitution):
    """A simulation of a sphere of ballast rock above a plane, and the id of the sphere."""
    scene = bris.Scene('spheres', step=STEP)
    rock = scene.add_material(density=2700, normal_stiffness=2e6, shear_stiffness=2e6, friction=0.5, restitution=restitution)
    scene.add_plane(point=(0, 0, 0), normal=(0, 0, 1), material=rock)
    sphere = scene.add_sphere(position=(0, 0, HEIGHT + RADIUS), radius=RADIUS, material=rock)
    return bris.Simulation(scene, law='linear_viscous'), sphere


def heights(restitution, duration=0.3, samples=300):
    """Times (s) and heights of the lowest point of the sphere (m)."""
    simulation, sphere = bouncing_sphere(restitution)
    path = []
    for _ in range(samples):
        simulation.advance(round(duration / STEP / samples))
        path.append((simulation.time, simulation.position(sphere)[2] - RADIUS))
    return np.array(path).T


def rebound(time, height):
    """Height of the first rebound, m: the largest height after the lowest one of the first fall."""
    landed = np.argmin(height[time < 1.2 * np.sqrt(2 * HEIGHT / 9.81)])
    return height[landed:].max()


def main(out):
    restitution = 0.8
    time, height = heights(restitution)
    found, exact = rebound(time, height), restitution**2 * HEIGHT
    print(f'rebound to {1e3 * found:.3f} mm, exact {1e3 * exact:.3f} mm')
    assert abs(found / exact - 1) < 2e-3
    plt.plot(time, height)
    plt.xlabel('time (s)')
    plt.ylabel('height (m)')
    plt.savefig(out / 'own_scenario.png', dpi=150)


if __name__ == '__main__':
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    main(folder)
