"""Recipe: a servo of your own. A plate is lowered onto a bed of spheres and keeps the pressure on it at a target.

The plate approaches at a constant speed until it touches. Then its velocity is proportional to the error of its force, such that
three tenths of the error would be removed between two corrections if the bed were made of upright columns of contacts."""
import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import bris

RADIUS, SIDE, LAYERS, STIFFNESS = 0.01, 6, 8, 1e6  # m, spheres, spheres, N/m of a contact
PRESSURE, STEP, EVERY, APPROACH = 20e3, 1e-5, 20, 0.2  # Pa, s, steps between corrections, m/s


def loose_bed(seed=1):
    """A box with a loose bed of spheres and a plate above it; the simulation and the id of the plate's body."""
    width, top = 2.2 * RADIUS * SIDE, 2.2 * RADIUS * LAYERS
    scene = bris.Scene('spheres', step=STEP)
    rock = scene.add_material(density=2700, normal_stiffness=2 * STIFFNESS, shear_stiffness=2 * STIFFNESS, friction=0.5,
                              normal_damping=5000, shear_damping=2500)
    for point, normal in (((0, 0, 0), (0, 0, 1)), ((0, 0, 0), (1, 0, 0)), ((0, 0, 0), (0, 1, 0)), ((width, 0, 0), (-1, 0, 0)),
                          ((0, width, 0), (0, -1, 0))):
        scene.add_plane(point, normal, rock)
    plate = scene.add_plane((0, 0, top), (0, 0, -1), rock, motion='prescribed')
    random = np.random.default_rng(seed)
    for k in np.ndindex(SIDE, SIDE, LAYERS):
        position = 2.2 * RADIUS * (np.array(k) + 0.5) + random.uniform(-0.05, 0.05, 3) * RADIUS
        scene.add_sphere(position, RADIUS, rock)
    return bris.Simulation(scene), plate, width**2


def main(out):
    simulation, plate, area = loose_bed()
    stiffness = SIDE**2 * STIFFNESS / LAYERS  # N/m, of columns of contacts in series
    history = []
    while simulation.time < 0.8:
        force = simulation.force(plate)[2]
        speed = 0.3 * (force - PRESSURE * area) / (stiffness * EVERY * STEP) if force > 0 else -APPROACH
        simulation.drive(plate, (0, 0, speed))
        simulation.advance(EVERY)
        history.append((simulation.time, force / area))
    time, pressure = np.array(history).T
    mean = pressure[time > 0.7].mean()
    print(f'pressure {mean / 1e3:.2f} kPa, wanted {PRESSURE / 1e3:.2f} kPa')
    assert abs(mean / PRESSURE - 1) < 0.01
    plt.plot(time, pressure / 1e3)
    plt.axhline(PRESSURE / 1e3, color='grey')
    plt.xlabel('time (s)')
    plt.ylabel('pressure on the plate (kPa)')
    plt.savefig(out / 'own_servo.png', dpi=150)


if __name__ == '__main__':
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    main(folder)
