"""Tests of the Python module. Run by ctest with the folder of the module on PYTHONPATH."""
import copy
import os
import pickle
import signal
import subprocess
import sys
import tempfile
import textwrap
import threading
import time
import unittest
from pathlib import Path

import numpy as np

import bris

BINARIES = Path(os.environ['BRIS_BINARIES'])
ROOT = Path(__file__).resolve().parents[3]
CLUMP, SMALL = ROOT / 'assets' / 'clumps' / 'rock_01.csv', ROOT / 'tests' / 'scenarios' / 'small'


def column_of_spheres(threads=1, count=30):
    """Spheres that fall on each other in a narrow shaft."""
    scene = bris.Scene('spheres', step=1e-5)
    rock = scene.add_material(density=2600, normal_stiffness=1e6, shear_stiffness=1e6, friction=0.5, normal_damping=3000)
    scene.add_plane((0, 0, 0), (0, 0, 1), rock)
    for normal in ((1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0)):
        scene.add_plane(tuple(-0.013 * n for n in normal), normal, rock)
    for k in range(count):
        scene.add_sphere((0.002 * (-1)**k, 0.001 * (-1)**(k // 2), 0.011 + 0.021 * k), 0.01, rock)
    return bris.Simulation(scene, threads=threads)


class ModuleTest(unittest.TestCase):
    def test_a_view_shows_the_memory_of_the_simulation(self):
        s = column_of_spheres()
        s.advance(100)
        velocity = s.view('bodies', 'velocity', write=True)
        velocity[:, 2] = 0.25
        again = s.view('bodies', 'velocity')
        self.assertTrue(np.shares_memory(velocity, again))
        self.assertTrue((s.state()['bodies/velocity'][:, 2] == 0.25).all())

    def test_no_step_is_taken_while_an_array_shows_a_column(self):
        s = column_of_spheres()
        height = s.view('bodies', 'position')[:, 2]
        with self.assertRaises(BufferError):
            s.advance()
        self.assertEqual(s.step, 0)
        del height
        s.advance()
        self.assertEqual(s.step, 1)

    def test_a_thread_that_uses_a_simulation_while_another_one_steps_it_is_refused(self):
        s = column_of_spheres()
        undisturbed = column_of_spheres()
        undisturbed.advance(60000)
        stepping = threading.Thread(target=s.advance, args=(60000,))
        stepping.start()
        calls = {'time': lambda: s.time, 'fingerprint': lambda: s.fingerprint, 'advance': s.advance, 'state': s.state,
                 'contacts': s.contacts, 'quantities': s.quantities, 'view': lambda: s.view('bodies', 'position', write=True),
                 'save': lambda: s.save('busy.ckpt.h5'), 'load': lambda: s.load('busy.ckpt.h5'), 'force': lambda: s.force(0),
                 'drive': lambda: s.drive(0, (0, 0, 1)), 'stable_step': s.stable_step, 'position': lambda: s.position(5)}
        try:
            while stepping.is_alive():
                self.assertEqual(s.step, 0)  # the steps have not begun
        except bris.BusyError:
            pass
        for name, call in calls.items():
            with self.subTest(name), self.assertRaisesRegex(bris.BusyError, 'another thread is running time steps'):
                call()
        stepping.join()
        self.assertEqual(s.fingerprint, undisturbed.fingerprint)

    def test_a_view_keeps_its_simulation_alive_and_is_read_only_unless_asked_for(self):
        view = column_of_spheres().view('bodies', 'position')
        self.assertAlmostEqual(view[:, 2].max(), 0.011 + 0.021 * 29)
        with self.assertRaises(ValueError):
            view[0, 0] = 1

    def test_a_sphere_moved_through_a_view_makes_new_contacts(self):
        s = column_of_spheres(count=2)
        s.advance(10)
        self.assertEqual(len(s.contacts()['kind']), 0)
        position = s.view('bodies', 'position', write=True)
        position[position[:, 2] > 0.005, 2] -= 0.0011  # all spheres; planes lie at 0
        del position
        s.advance(1)
        self.assertIn('plane', s.contacts()['kind'])

    def test_the_same_bits_on_one_and_two_threads_and_after_a_checkpoint(self):
        one, two = column_of_spheres(1), column_of_spheres(2)
        one.advance(3000)
        two.advance(1000)
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / 'state.ckpt.h5'
            two.save(path)
            third = column_of_spheres()
            third.load(path)
            third.advance(2000)
            checkpoint = bris.read_checkpoint(path)
        two.advance(2000)
        self.assertEqual(one.fingerprint, two.fingerprint)
        self.assertEqual(one.fingerprint, third.fingerprint)
        self.assertEqual((checkpoint['scenario'], checkpoint['step']), ('python', 1000))
        self.assertEqual(checkpoint['state']['bodies/position'].shape[1], 3)

    def test_contact_forces_on_the_floor_carry_the_weight(self):
        s = column_of_spheres()
        s.advance(60000)
        contacts = s.contacts()
        weight = 30 * 2600 * 4 / 3 * np.pi * 0.01**3 * 9.81
        planes = np.array(contacts['kind']) == 'plane'
        self.assertTrue((contacts['partner'][planes] < 5).all())  # spheres own their contacts with planes
        self.assertAlmostEqual(contacts['force'][planes, 2].sum() / weight, 1, delta=1e-3)
        self.assertAlmostEqual(s.quantities()['boundary_force_N'][2] / weight, -1, delta=1e-3)

    def test_facets_carry_spheres_as_the_plane_that_they_lie_in(self):
        heights = {}
        for walls in ('plane', 'facet'):
            scene = bris.Scene('spheres', step=1e-5)
            rock = scene.add_material(density=2600, normal_stiffness=1e6, shear_stiffness=1e6, friction=0.5, normal_damping=3000)
            if walls == 'plane':
                scene.add_plane((0, 0, 0), (0, 0, 1), rock)
            else:
                corners = np.array([[[-1, -1, 0], [1, -1, 0], [1, 1, 0]], [[-1, -1, 0], [1, 1, 0], [-1, 1, 0]]]) / 10
                scene.add_facets(corners, rock)
            ball = scene.add_sphere((0.01, 0.02, 0.012), 0.01, rock)
            simulation = bris.Simulation(scene)
            simulation.advance(20000)
            self.assertEqual(set(simulation.contacts()['kind']), {walls})
            heights[walls] = simulation.position(ball)[2]
        self.assertAlmostEqual(heights['plane'], heights['facet'], delta=1e-12)

    def test_a_membrane_keeps_its_pressure_while_the_platen_moves(self):
        scene = bris.Scene('spheres', step=1e-5, gravity=(0, 0, 0))
        rock = scene.add_material(density=2600, normal_stiffness=1e6, shear_stiffness=1e6, friction=0.3)
        draw = np.random.default_rng(1)
        for layer in range(6):
            for k in range(7):
                angle = k * np.pi / 3 + layer
                at = (0, 0) if k == 6 else (0.021 * np.cos(angle), 0.021 * np.sin(angle))
                scene.add_sphere((*at, 0.0102 + 0.0203 * layer), 0.01 * draw.uniform(0.97, 1), rock)
        scene.add_membrane(radius=0.0325, height=0.122, rings=3, sectors=8, pressure=1e4, contact_stiffness=1e6, material=rock)
        simulation = bris.Simulation(scene, law='linear')
        simulation.advance(40000)
        simulation.move_platen(0.005)
        simulation.advance(40000)
        np.testing.assert_allclose(simulation.membrane_pressure(), 1e4, rtol=0.05)
        self.assertIn('membrane', simulation.contacts()['kind'])

    def test_rows_of_a_state_are_in_the_order_of_the_ids(self):
        s = column_of_spheres()
        s.advance(2000)
        self.assertTrue((np.diff(s.state()['bodies/id'].astype(int)) > 0).all())

    def test_bad_input_is_named(self):
        with self.assertRaisesRegex(bris.InputError, 'expected one of density, .*found colour'):
            bris.Scene('spheres', step=1e-5).add_material(colour=1)
        with self.assertRaisesRegex(ValueError, 'expected spheres or clumps, found cubes'):
            bris.Scene('cubes', step=1e-5)
        with self.assertRaisesRegex(bris.InputError, 'index below 0'):
            bris.Scene('spheres', step=1e-5).add_sphere((0, 0, 0), 1, 0)
        s = column_of_spheres()
        with self.assertRaisesRegex(bris.InputError, 'found bodies.colour'):
            s.view('bodies', 'colour')
        with self.assertRaisesRegex(bris.InputError, 'prescribed'):
            s.drive(0, (0, 0, 1))
        scene = bris.Scene('clumps', step=1e-5)
        with self.assertRaisesRegex(bris.InputError, 'three on a line'):
            scene.add_facets([[(0, 0, 0), (1, 0, 0), (2, 0, 0)]], scene.add_material(density=2600))
        with self.assertRaisesRegex(bris.InputError, 'membrane'):
            s.move_platen(1)
        with self.assertRaises(OSError):
            s.load('no/such/file.ckpt.h5')
        scene = bris.Scene('spheres', step=1e-5)
        with self.assertRaisesRegex(bris.InputError, 'others in sample 1'):
            scene.add_sensor(scene.add_sphere((0, 0, 1), 0.01, scene.add_material(density=2600)), [0, 1], [(0, 0, 1), (0, 0, float('nan'))])
        with self.assertRaisesRegex(bris.InputError, '1 to 1000 rings'):
            scene.add_membrane(0.1, 0.2, rings=2000000000, sectors=8, pressure=1e4, contact_stiffness=1e6, material=0)
        for voxel in (float('inf'), float('nan'), 0.0, -1.0, 1e-300, 1e-6):
            with self.assertRaisesRegex(bris.InputError, 'voxel: expected at most'):
                s.field('porosity', voxel=voxel)

    def test_indices_and_shapes_are_read_only(self):
        s = column_of_spheres()
        s.advance(10)
        for table, column in (('bodies', 'material'), ('bodies', 'id'), ('spheres', 'parent'), ('planes', 'host'), ('spheres', 'ball'),
                              ('bodies', 'bounding_radius'), ('bodies', 'mass'), ('bodies', 'inertial_mass'), ('bodies', 'sphere_inertia'),
                              ('bodies', 'acceleration'), ('bodies', 'angular_momentum'), ('sphere_pairs', 'spring')):
            with self.assertRaisesRegex(bris.InputError, f'expected one of the columns position, .* found {table}.{column}'):
                s.view(table, column, write=True)
            view = s.view(table, column)
            with self.assertRaises(ValueError):
                view[...] = 0
            if len(view):
                with self.assertRaises(ValueError):
                    view.setflags(write=True)

    def test_a_checkpoint_of_another_scene_or_law_is_refused_and_changes_nothing(self):
        s = column_of_spheres()
        s.advance(100)
        with tempfile.TemporaryDirectory() as folder:
            run = Path(folder) / 'settle'
            subprocess.run([BINARIES / 'settle', '--spheres', '20', '--duration', '0.001', '--quiet', '--out', run], check=True)
            other = Path(folder) / 'other.ckpt.h5'
            column_of_spheres(count=29).save(other)
            before = s.fingerprint
            for path, found in ((run / 'settle.ckpt.h5', 'one of settle'), (other, 'one of another scene or law')):
                with self.assertRaisesRegex(bris.InputError, found):
                    s.load(path)
                self.assertEqual(s.fingerprint, before)

    def test_a_checkpoint_replaces_files_only(self):
        s = column_of_spheres(count=2)
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            os.mkfifo(folder / 'pipe')
            with self.assertRaisesRegex(OSError, 'expected a file, found a pipe'):
                s.save(folder / 'pipe')
            (folder / 'link').symlink_to(folder / 'target.ckpt.h5')
            s.save(folder / 'link')
            self.assertTrue((folder / 'link').is_symlink())
            s.load(folder / 'target.ckpt.h5')

    def test_ctrl_c_ends_a_long_advance(self):
        code = 'import sys, test; s = test.column_of_spheres(); print("ready", flush=True); s.advance(10**12)'.replace('test', Path(__file__).stem)
        process = subprocess.Popen([sys.executable, '-c', code], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                                   env={**os.environ, 'PYTHONPATH': os.pathsep.join([str(Path(__file__).parent), *sys.path])})
        process.stdout.readline()
        time.sleep(0.5)
        process.send_signal(signal.SIGINT)
        self.assertIn('KeyboardInterrupt', process.communicate(timeout=60)[1])

    def test_csv_files_have_whole_numbers_numbers_and_text(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / 'a.csv'
            path.write_text('# a comment\nstep,a-b,name,gap\n1,0.5,"one, #1",5\n2,,two,\n')
            table = bris.read_csv(path)
            self.assertEqual(list(table), ['step', 'a-b', 'name', 'gap'])
            np.testing.assert_array_equal(table['step'], [1, 2])
            np.testing.assert_array_equal(table['a-b'], [0.5, np.nan])
            np.testing.assert_array_equal(table['gap'], [5, np.nan])
            self.assertEqual(list(table['name']), ['one, #1', 'two'])
            for text, what in (('', 'found an empty file'), ('a,b\n1\n', 'expected 2 columns, found 1')):
                path.write_text(text)
                with self.assertRaisesRegex(ValueError, what):
                    bris.read_csv(path)
            path.write_text('{"a": 1')
            with self.assertRaisesRegex(ValueError, 'a.csv'):
                bris.read_summary(path)
            with self.assertRaisesRegex(OSError, 'a.csv: expected a run file'):
                bris.open_run(path)

    def test_fines_fill_the_voids_of_a_box_and_fields_show_them(self):
        scene = bris.Scene('spheres', step=1e-5)
        rock = scene.add_material(density=2600, normal_stiffness=1e6, shear_stiffness=1e6, friction=0.5, normal_damping=3000)
        side = 0.06
        for point, normal in (((0, 0, 0), (1, 0, 0)), ((side, 0, 0), (-1, 0, 0)), ((0, 0, 0), (0, 1, 0)), ((0, side, 0), (0, -1, 0)),
                              ((0, 0, 0), (0, 0, 1))):
            scene.add_plane(point, normal, rock)
        for k in range(27):
            scene.add_sphere((0.01 + 0.02 * (k % 3), 0.01 + 0.02 * (k // 3 % 3), 0.01 + 0.02 * (k // 9)), 0.01, rock)
        scene.add_fines(p4=20, p200=4, saturation=0.5, voxel=2.5e-3, high=(1, 1, side))
        with self.assertRaisesRegex(bris.InputError, 'no body after the fines'):
            scene.add_sphere((0, 0, 1), 0.01, rock)
        s = bris.Simulation(scene)
        fouling, porosity, fines = s.fouling(), s.field('porosity'), s.field('fouling')
        solid = 27 * 4 / 3 * np.pi * 0.01**3
        self.assertAlmostEqual(fouling['ballast_mass_kg'], 2600 * solid)
        self.assertAlmostEqual(fouling['fines_mass_kg'] / (fouling['fines_mass_kg'] + 2600 * solid), 0.2)
        self.assertAlmostEqual(fouling['void_volume_m3'] / (side**3 - solid), 1, delta=0.02)
        self.assertEqual(porosity['values'].shape, (24, 24, 24))
        self.assertEqual(porosity['voxel'], 2.5e-3)
        np.testing.assert_allclose(porosity['origin'], 1.25e-3, rtol=1e-9)
        self.assertAlmostEqual(np.nanmean(porosity['values']), 1 - solid / side**3, delta=2e-3)
        self.assertGreater(np.nanmax(fines['values']), 0)
        self.assertEqual(s.field('velocity')['values'].shape, (24, 24, 24, 3))
        with self.assertRaisesRegex(bris.InputError, 'porosity'):
            s.field('colour')
        with self.assertRaisesRegex(bris.InputError, 'found none'):
            column_of_spheres().fouling()

    def test_a_sensor_pulls_its_sphere_to_the_recorded_path(self):
        heights = []
        for recorded in (False, True):
            scene = bris.Scene('spheres', step=1e-5)
            rock = scene.add_material(density=2600, normal_stiffness=1e6, friction=0.5)
            scene.add_plane((0, 0, 0), (0, 0, 1), rock)
            ball = scene.add_sphere((0, 0, 0.5), 0.01, rock)
            times = [1e-3 * k for k in range(1, 50)]
            if recorded:  # it falls with 9 m/s2 only
                scene.set_filter(position=1e-3, velocity=0.1, acceleration_density=1e-2)
                scene.add_sensor(ball, times, [(0, 0, 0.5 - 4.5 * t**2) for t in times], deviation=1e-6)
            s = bris.Simulation(scene)
            s.advance(4900)
            heights.append(s.position(ball)[2])
        self.assertAlmostEqual(heights[0], 0.5 - 4.905 * 0.049**2, delta=5e-6)
        self.assertAlmostEqual(heights[1], 0.5 - 4.5 * 0.049**2, delta=2e-5)
        self.assertEqual(s.state()['sensors/accepted'], 49)
        with self.assertRaisesRegex(bris.InputError, 'as many positions'):
            bris.Scene('spheres', step=1e-5).add_sensor(0, [1.0], [])

    def test_an_inertial_sensor_records_nothing_in_free_fall(self):
        scene = bris.Scene('clumps', step=1e-5)
        rock = scene.add_material(density=2600, normal_stiffness=1e6, friction=0.5)
        scene.add_plane((0, 0, 0), (0, 0, 1), rock)
        ball = scene.add_rock(CLUMP, 0.03, (0, 0, 0.5), material=rock)
        scene.add_recorder(ball, device='smartrock-like', rate=500)
        s = bris.Simulation(scene)
        s.advance(10000)
        (exact,), (real,) = s.recordings(exact=True), s.recordings()
        self.assertEqual((exact['body'], exact['force'].shape), (ball, (50, 3)))
        self.assertLess(np.abs(exact['force']).max(), 1e-9)
        self.assertGreater(real['force'].std(), 0)
        with self.assertRaisesRegex(bris.InputError, 'inertial'):
            column_of_spheres().recordings()

    def test_a_step_beyond_the_stable_one_is_refused(self):
        scene = bris.Scene('spheres', step=1e-2)
        rock = scene.add_material(density=2600, normal_stiffness=1e6, friction=0.5)
        scene.add_plane((0, 0, 0), (0, 0, 1), rock)
        scene.add_sphere((0, 0, 1), 0.01, rock)
        with self.assertRaisesRegex(bris.InputError, 'stable step'):
            bris.Simulation(scene)

    def test_what_a_view_has_written_is_checked_before_a_step_or_a_checkpoint(self):
        nan, infinity = float('nan'), float('inf')
        for column, row, value, what in (('position', 7, (nan, 0, 0), 'position: expected finite numbers'), ('position', 7, infinity, 'position: expected'),
                                         ('velocity', 7, nan, 'velocity: expected finite'), ('angular_velocity', 7, -infinity, 'angular_velocity: expected'),
                                         ('drive_velocity', 0, (0, 0, 1), 'motion is not prescribed'), ('velocity', 0, (0, 0, 1), 'that is not free')):
            with self.subTest(column, row=row, value=value):
                s = column_of_spheres()
                s.advance(20)
                s.view('bodies', column, write=True)[row] = value
                with tempfile.TemporaryDirectory() as folder:
                    for call in (s.advance, lambda: s.save(Path(folder) / 'state.ckpt.h5'), s.advance):
                        with self.assertRaisesRegex(bris.InputError, f'view: body .*{what}'):
                            call()
                    self.assertEqual(list(Path(folder).iterdir()), [])
                self.assertEqual(s.step, 20)

    def test_a_rock_that_is_turned_through_a_view_needs_a_unit_quaternion(self):
        scene = bris.Scene('clumps', step=1e-5)
        rock = scene.add_material(density=2600, normal_stiffness=1e6, friction=0.5)
        scene.add_plane((0, 0, 0), (0, 0, 1), rock)
        body = scene.add_rock(CLUMP, 0.03, (0, 0, 0.5), material=rock)
        s = bris.Simulation(scene)
        for wrong in ((0, 0, 0, 0), (1, 1, 0, 0), (float('nan'), 0, 0, 1)):
            s.view('bodies', 'orientation', write=True)[body] = wrong
            with self.assertRaisesRegex(bris.InputError, 'orientation: expected'):
                s.advance()
        s.view('bodies', 'orientation', write=True)[body] = (0.6, 0, 0, 0.8)
        s.view('bodies', 'angular_velocity', write=True)[body] = (0, 0, 2)
        s.advance(10)
        np.testing.assert_allclose(s.state()['bodies/angular_velocity'][body], (0, 0, 2), atol=1e-3)  # free flight
        self.assertGreater(np.abs(s.state()['bodies/angular_momentum'][body]).max(), 0)

    def test_a_writable_view_that_nobody_writes_to_changes_no_bit(self):
        s, untouched = column_of_spheres(), column_of_spheres()
        for _ in range(20):
            view = s.view('bodies', 'position', write=True), s.view('bodies', 'angular_velocity', write=True)
            del view
            s.advance(100)
        untouched.advance(2000)
        self.assertEqual(s.fingerprint, untouched.fingerprint)

    def test_objects_that_were_never_initialised_raise(self):
        for kind in (bris.Scene, bris.Simulation):
            empty = kind.__new__(kind)
            for name in dir(kind):
                if name.startswith('__'):
                    continue
                with self.subTest(name), self.assertRaises((TypeError, ValueError)):
                    call = getattr(empty, name)  # properties raise here
                    arguments = {'add_sphere': ((0, 0, 0), 1, 0), 'add_rock': (CLUMP, 1, (0, 0, 0), (0, 0, 0, 1), 0), 'add_plane': ((0, 0, 0), (0, 0, 1), 0),
                                 'add_facets': ([], 0), 'set_velocity': (0, (0, 0, 0)), 'add_sensor': (0, [], []), 'add_recorder': (0,), 'drive': (0, (0, 0, 0)),
                                 'force': (0,), 'position': (0,), 'view': ('bodies', 'position'), 'field': ('porosity',), 'move_platen': (1,), 'save': ('x',),
                                 'load': ('x',), 'add_fines': (1,)}
                    keywords = {'add_membrane': dict(radius=1, height=1, pressure=1, contact_stiffness=1, material=0)}
                    call(*arguments.get(name, ()), **keywords.get(name, {}))
        with self.assertRaisesRegex(TypeError, '__init__ was not called'):
            bris.Simulation(bris.Scene.__new__(bris.Scene))

        class Careless(bris.Scene):
            def __init__(self):
                pass
        with self.assertRaises(TypeError):
            Careless()

    def test_a_scene_that_is_refused_can_be_completed(self):
        scene = bris.Scene('spheres', step=1e-5)
        rock = scene.add_material(density=2600, normal_stiffness=1e6)
        with self.assertRaisesRegex(bris.InputError, 'at least one body'):
            bris.Simulation(scene)
        scene.add_sphere((0, 0, 0), 0.01, rock)
        for wrong in (dict(law='no such law'), dict(threads=10**6)):
            with self.assertRaises(bris.InputError):
                bris.Simulation(scene, **wrong)
        s = bris.Simulation(scene)
        s.advance(10)
        for use in (lambda: scene.add_sphere((0, 0, 1), 0.01, rock), lambda: scene.add_material(density=1), lambda: bris.Simulation(scene),
                    lambda: scene.add_facets([[(0, 0, 0), (1, 0, 0), (0, 1, 0)]], rock),
                    lambda: scene.add_membrane(radius=1, height=1, pressure=1, contact_stiffness=1, material=rock)):
            with self.assertRaisesRegex(bris.InputError, 'no simulation has taken over'):
                use()

    def test_numbers_that_no_scene_can_have_are_refused(self):
        nan, infinity = float('nan'), float('inf')
        for step in (nan, infinity, 0, -1):
            with self.assertRaisesRegex(bris.InputError, 'step: expected'):
                bris.Scene('spheres', step=step)
        with self.assertRaisesRegex(bris.InputError, 'gravity'):
            bris.Scene('spheres', step=1e-5, gravity=(0, 0, nan))
        scene = bris.Scene('clumps', step=1e-5)
        rock = scene.add_material(density=2600, normal_stiffness=1e6)
        fixed = scene.add_plane((0, 0, 0), (0, 0, 1), rock)
        square = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
        for x in (nan, infinity, -infinity):
            for call in (lambda: scene.add_sphere((x, 0, 0), 1, rock), lambda: scene.add_sphere((0, 0, 0), x, rock), lambda: scene.add_plane((0, x, 0), (0, 0, 1), rock),
                         lambda: scene.add_plane((0, 0, 0), (0, 0, x), rock), lambda: scene.add_facets([[(x, 0, 0), *square[1:]]], rock),
                         lambda: scene.add_rock(CLUMP, x, (0, 0, 0), material=rock), lambda: scene.add_rock(CLUMP, 1, (0, x, 0), material=rock),
                         lambda: scene.add_rock(CLUMP, 1, (0, 0, 0), (x, 0, 0, 1), material=rock), lambda: scene.set_velocity(fixed, (x, 0, 0)),
                         lambda: scene.add_membrane(radius=x, height=1, pressure=1, contact_stiffness=1, material=rock),
                         lambda: scene.add_recorder(fixed, rate=x), lambda: scene.add_sensor(fixed, [1.0], [(0, 0, 0)], deviation=x)):
                with self.assertRaises(bris.InputError):
                    call()
        for wrong in ((0, 0, 0), (1e-200, 0, 0), (1e200, 0, 0)):
            with self.assertRaises(bris.InputError):
                scene.add_plane((0, 0, 0), wrong, rock)
        with self.assertRaises(bris.InputError):
            scene.add_rock(CLUMP, 1, (0, 0, 0), (0, 0, 0, 0), material=rock)
        with self.assertRaisesRegex(bris.InputError, 'four corners in a plane'):
            scene.add_facets([[*square[:2], (1, 1, 0.1), square[3]]], rock)
        with self.assertRaisesRegex(bris.InputError, 'convex'):
            scene.add_facets([[square[0], square[2], square[1], square[3]]], rock)
        with self.assertRaisesRegex(bris.InputError, 'free or prescribed'):
            scene.set_velocity(fixed, (0, 0, 1))

    def child(self, code, timeout=60):
        """Output of a process that runs Python code with this file as `test`; it must end by itself, without a signal."""
        code = 'import os, sys, threading, time, bris, numpy as np, module_test as test\n' + textwrap.dedent(code)
        # from 3.12 on Python advises against any fork of a process with threads
        done = subprocess.run([sys.executable, '-W', 'ignore::DeprecationWarning', '-c', code], capture_output=True, text=True, timeout=timeout,
                              env={**os.environ, 'PYTHONPATH': os.pathsep.join([str(Path(__file__).parent), *sys.path])})
        self.assertGreaterEqual(done.returncode, 0, done.stderr)
        return done

    def test_a_daemon_thread_that_steps_does_not_crash_the_end_of_the_interpreter(self):
        for threads in (1, 2):
            done = self.child(f'''
                def work():
                    s = test.column_of_spheres(threads={threads})
                    while True:
                        try:
                            s.advance(10**9)
                        except BaseException:
                            pass
                for _ in range(3):
                    threading.Thread(target=work, daemon=True).start()
                time.sleep(0.3)
                print('end')''')
            self.assertEqual((done.returncode, done.stdout, done.stderr), (0, 'end\n', ''))

    def test_a_forked_process_computes_or_says_why_it_cannot(self):
        done = self.child('''
            one, two = test.column_of_spheres(1), test.column_of_spheres(2)
            one.advance(100)
            child = os.fork()
            if child == 0:
                one.advance(100)
                two.advance(100)  # no thread existed before the fork
                test.column_of_spheres(2).advance(100)
                sys.exit(7)
            assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 7
            two.advance(100)
            child = os.fork()
            if child == 0:
                one.advance(100)
                for refused in (two, test.column_of_spheres(2)):
                    try:
                        refused.advance(100)
                    except RuntimeError as error:
                        assert 'spawn' in str(error)
                    else:
                        os._exit(1)
                one.field('porosity'), one.contacts(), one.quantities()
                sys.exit(7)
            assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 7
            one.advance(100)
            print(one.fingerprint == two.fingerprint)''')
        self.assertEqual((done.returncode, done.stderr), (0, ''))

    def test_objects_are_neither_copied_nor_pickled(self):
        scene = bris.Scene('spheres', step=1e-5)
        for thing in (scene, column_of_spheres()):
            for copied in (copy.copy, copy.deepcopy, pickle.dumps):
                with self.assertRaises(TypeError):
                    copied(thing)

    def test_simulations_of_several_threads_do_not_disturb_each_other(self):
        alone = column_of_spheres()
        alone.advance(5000)
        fingerprints = []

        def work(threads):
            s = column_of_spheres(threads)
            for _ in range(10):
                s.advance(500)
                s.contacts(), s.state(), s.quantities()
            fingerprints.append(s.fingerprint)
        threads = [threading.Thread(target=work, args=(1 + k % 2,)) for k in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(fingerprints, [alone.fingerprint] * 4)

    def test_a_guard_that_stops_the_run_raises_simulation_error(self):
        s = column_of_spheres()
        velocity = s.view('bodies', 'velocity', write=True)
        velocity[7, 2] = 1e5
        del velocity
        with self.assertRaisesRegex(bris.SimulationError, 'step'):
            s.advance(10)

    def test_a_run_file_gives_the_frames_that_were_written(self):
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run([BINARIES / 'settle', '--spheres=200', '--duration=0.02', '--quiet', f'--out={folder}'], check=True,
                           stdout=subprocess.DEVNULL)
            summary, table = bris.read_summary(folder), bris.read_csv(Path(folder) / 'settle.csv')
            with bris.open_run(folder) as run:
                last, series = run.frame(-1), run.series('motion')
                self.assertAlmostEqual(run.times[-1], 0.02)
                self.assertEqual(run.units['velocity'], 'm/s')
        self.assertEqual(last['position'].shape, (200, 3))
        self.assertEqual(summary['spheres'], 200)
        np.testing.assert_allclose(series['kinetic_energy'], table['kinetic_energy_J'], rtol=1e-6)

    def test_contacts_of_a_run_file_are_those_of_its_summary(self):
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run([BINARIES / 'settle', '--spheres=200', '--duration=0.5', '--quiet', '--write=contacts', f'--out={folder}'],
                           check=True, stdout=subprocess.DEVNULL)
            summary = bris.read_summary(folder)
            with bris.open_run(folder) as run:
                times = run.times
            with bris.open_run(Path(folder) / 'settle_contacts.vtkhdf') as run:
                np.testing.assert_array_equal(run.times, times)
                self.assertEqual(run.units['normal_force'], 'N')
                ends, lines = run.frame(-1), run.cells(-1)
        self.assertEqual(len(lines['normal_force']), summary['contacts'])
        self.assertEqual(lines['corners'].shape, (summary['contacts'], 2))
        self.assertEqual(len(ends['position']), 2 * summary['contacts'])
        self.assertAlmostEqual(lines['normal_force'].mean(), summary['mean_normal_force_N'], delta=1e-5 * summary['mean_normal_force_N'])

    def test_quaternions_of_run_files_are_in_the_order_of_those_of_simulations_and_checkpoints(self):
        with tempfile.TemporaryDirectory() as folder:
            results = bris.run('triaxial', config=SMALL / 'specimen.cfg', grading=SMALL / 'grading.csv', confining_pressure=55e3, beds='none', out=folder)
            state = bris.read_checkpoint(next(Path(folder).glob('triaxial*.ckpt.h5')))['state']
            with results.open_run() as run:
                last = run.frame(-1)
        rows = np.searchsorted(state['bodies/id'], last['id'].astype(int))
        expected = state['bodies/orientation'][rows]
        self.assertGreater(np.abs(np.diff(expected, axis=1)).max(), 0.1)  # an order can be seen
        np.testing.assert_allclose(last['orientation'], expected, atol=1e-6)

    def test_a_run_gives_its_tables_as_arrays_and_its_summary_as_a_dictionary(self):
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / 'old.csv').write_text('a\n1\n')
            os.utime(Path(folder) / 'old.csv', (1, 1))
            results = bris.run('settle', spheres=30, duration=0.002, threads=np.int64(1), relax=False, seed=None, out=folder)
            self.assertEqual(results.tables, ['settle'])
            self.assertEqual(results.summary['spheres'], 30)
            self.assertAlmostEqual(results['settle']['time_s'][-1], 0.002)
            self.assertIn('floor force over weight', results.text)
            self.assertIn('--spheres=30', results.report.read_text())
            with self.assertRaisesRegex(KeyError, 'expected one of settle, found old'):
                results['old']
            with results.open_run() as run:
                self.assertEqual(run.frame(0)['position'].shape, (30, 3))

    def test_a_run_that_fails_raises_what_the_program_said(self):
        with tempfile.TemporaryDirectory() as folder:
            for scenario, options, error, what in (('settle', dict(sphere=3), bris.InputError, '--sphere.*did you mean --spheres'),
                                                   ('settle', dict(spheres=0), bris.InputError, '--spheres: expected a whole number'),
                                                   ('settle', dict(explain=True), bris.InputError, 'expected options of a run, found explain'),
                                                   ('settel', {}, bris.InputError, 'expected one of ballast_box, .*found "settel"'),
                                                   ('settle', dict(resume='no/such/file'), bris.OutputError, 'cannot read')):
                with self.subTest(scenario, **options), self.assertRaisesRegex(error, what):
                    bris.run(scenario, out=folder, **options)

    def test_a_file_that_is_no_whole_run_file_is_refused_in_words_of_this_project(self):
        with tempfile.TemporaryDirectory() as folder:
            bris.run('settle', spheres=30, duration=0.002, out=folder)
            file, damaged, other = (Path(folder) / name for name in ('settle.vtkhdf', 'damaged.vtkhdf', 'settle.ckpt.h5'))
            damaged.write_bytes(file.read_bytes()[:-1000])
            for path, error in ((damaged, bris.OutputError), (other, bris.InputError), (Path(folder) / 'absent.vtkhdf', bris.OutputError)):
                with self.subTest(path.name), self.assertRaisesRegex(error, f'{path.name}: expected a run file, found') as caught:
                    bris.open_run(path)
                self.assertTrue(caught.exception.__suppress_context__ or caught.exception.__context__ is None)
            with bris.open_run(file) as run:
                frames = len(run)
                for call, error, what in ((lambda: run.frame(frames), IndexError, f'expected a frame from -{frames} to {frames - 1}, found {frames}'),
                                          (lambda: run.series('x'), bris.InputError, 'expected a series among motion, found x')):
                    with self.assertRaisesRegex(error, what):
                        call()
            with self.assertRaisesRegex(bris.InputError, 'expected an open run file, found it closed'):
                run.frame(0)
            done = self.child(f"""
                sys.modules['h5py'] = None
                print(bris.read_summary({folder!r})['spheres'])
                bris.open_run({str(file)!r})""")
            self.assertEqual(done.stdout, '30\n')
            self.assertIn('ImportError: open_run: expected h5py, found none', done.stderr)

    def test_porosity_of_a_slope_does_not_count_the_air_above_it(self):
        scene = bris.Scene('spheres', step=1e-5)
        rock = scene.add_material(density=2600, normal_stiffness=1e6, shear_stiffness=1e6, friction=0.5, normal_damping=3000)
        for point, normal in (((0, 0, 0), (1, 0, 0)), ((0.2, 0, 0), (-1, 0, 0)), ((0, 0, 0), (0, 1, 0)), ((0, 0.1, 0), (0, -1, 0)), ((0, 0, 0), (0, 0, 1))):
            scene.add_plane(point, normal, rock)
        for i in range(10):
            for k in range(5 * (10 - i)):
                scene.add_sphere((0.01 + 0.02 * i, 0.01 + 0.02 * (k % 5), 0.01 + 0.02 * (k // 5)), 0.01, rock)
        values = bris.Simulation(scene).field('porosity', voxel=2e-3)['values']
        self.assertAlmostEqual(np.nanmean(values), 1 - np.pi / 6, delta=0.03)  # of a cubic lattice
        self.assertTrue(np.isnan(values[-5:, :, -20:]).all())

    def test_a_folder_without_a_run_file_is_refused(self):
        with tempfile.TemporaryDirectory() as folder, self.assertRaisesRegex(ValueError, 'found 0'):
            bris.open_run(folder)


if __name__ == '__main__':
    unittest.main(argv=sys.argv[:1])
