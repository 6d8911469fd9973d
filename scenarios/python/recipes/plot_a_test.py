"""Recipe: plot a test. Deviatoric stress and volumetric strain of a triaxial test against axial strain, and its rocks in the last
frame. Usage: plot_a_test.py OUT [FOLDER], with the folder that `scenarios/run triaxial --out FOLDER` has written; without one a
short test of a small specimen is run first."""
import sys
from pathlib import Path

import matplotlib.pyplot as plt

import bris


def short_test(folder):
    return bris.run('triaxial', grading='arema_3', bodies=160, porosity=0.42, confining_pressure=110e3, final_axial_strain=0.002,
                    out=folder).folder


def main(out, folder):
    curve, summary = bris.read_csv(folder / 'curve.csv'), bris.read_summary(folder)
    with bris.open_run(folder) as run:
        last = run.frame(-1)
        print(f"{len(last['position'])} rocks, {len(run)} frames, peak q {summary['peak_q_Pa'] / 1e3:.0f} kPa")
        assert len(last['position']) >= summary['bodies']
    assert curve['axial_strain'][-1] > 0
    figure, (stress, volume, rocks) = plt.subplots(1, 3, figsize=(12, 4))
    stress.plot(100 * curve['axial_strain'], curve['deviatoric_stress_Pa'] / 1e3)
    stress.set(xlabel='axial strain (%)', ylabel='deviatoric stress (kPa)')
    volume.plot(100 * curve['axial_strain'], 100 * curve['volumetric_strain'])
    volume.set(xlabel='axial strain (%)', ylabel='volumetric strain (%)')
    x, _, z = last['position'].T
    points = rocks.scatter(x, z, s=20, c=last['coordination'])
    figure.colorbar(points, label='coordination number')
    rocks.set(xlabel='x (m)', ylabel='z (m)', aspect='equal')
    figure.tight_layout()
    figure.savefig(out / 'plot_a_test.png', dpi=150)


if __name__ == '__main__':
    target = Path(sys.argv[1])
    target.mkdir(parents=True, exist_ok=True)
    main(target, Path(sys.argv[2]) if len(sys.argv) > 2 else short_test(target / 'test'))
