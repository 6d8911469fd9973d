"""A scene of the comparison in Yade: yade -n -x -jT yade.py BED name=value ... (names as in lammps.in).

Linear law: ViscElMat, with the stiffnesses and dashpots of both partners in series. Its dashpot does not depend on the
reduced mass: it is that of two equal bodies, and twice as large at a wall, so the bed of two sizes has another dashpot.
Hertz: MindlinPhys with a restitution of 0.3. Mass and inertia of clumps are summed over their spheres.
"""
import math
import os
import sys
import time

from yade import utils

words = dict(word.split('=') for word in sys.argv[2:])
number = {name: float(text) for name, text in words.items() if name not in ('law', 'data', 'places')}
dt, gz, kn, kt, gn, gt = (number[name] for name in ('dt', 'gz', 'kn', 'kt', 'gn', 'gt'))
density, angle = 2600., math.atan(0.5)

with open(sys.argv[1]) as bed:
    box = [float(word) for word in bed.readline().split()[1:]]
    rows = [[float(word) for word in line.split()] for line in bed]
groups = {}
for n, row in enumerate(rows):
    groups.setdefault(row[4] if len(row) > 4 else n, []).append(row)
mass = min(sum(4 / 3 * math.pi * density * row[3]**3 for row in group) for group in groups.values())

if words['law'] == 'linear':
    grain = ViscElMat(kn=2 * kn, ks=2 * kt, cn=mass * gn, cs=mass * gt, density=density, frictionAngle=angle)
    stiff = 1e12  # in series with it the grain's dashpot remains, with the whole mass of the grain
    wall = ViscElMat(kn=2 * kn, ks=2 * kt, cn=stiff, cs=stiff, density=density, frictionAngle=angle)
    physics, law = Ip2_ViscElMat_ViscElMat_ViscElPhys(), Law2_ScGeom_ViscElPhys_Basic()
else:
    grain = wall = FrictMat(young=5e8, poisson=0.25, density=density, frictionAngle=angle)
    physics, law = Ip2_FrictMat_FrictMat_MindlinPhys(en=0.3, es=0.3), Law2_ScGeom_MindlinPhys_Mindlin()
O.materials.append(grain)

movers, grains = [], []
for group in groups.values():
    spheres = [utils.sphere(row[:3], row[3], material=grain) for row in group]
    if len(rows[0]) > 4:
        mover, members = O.bodies.appendClumped(spheres, discretization=0)
    else:
        mover = O.bodies.append(spheres[0])
        members = [mover]
    movers.append(mover)
    grains += members
walls = [O.bodies.append(utils.wall(place, axis=axis, sense=sense, material=wall))
         for axis in range(3) for place, sense in ((0., 1), (box[axis], -1))]

driven = set()
if number['speed'] > 0:
    for n in movers:
        body = O.bodies[n]
        if number['low'] <= body.state.pos[2] <= number['high']:
            continue
        body.state.blockedDOFs = 'xyzXYZ'
        body.state.vel = Vector3(number['speed'] if body.state.pos[2] > number['high'] else 0, 0, 0)
        body.groupMask = 3 if body.state.vel[0] == 0 else 5  # their forces on each other have no effect
        driven.add(n)

O.engines = [
    ForceResetter(),
    InsertionSortCollider([Bo1_Sphere_Aabb(), Bo1_Wall_Aabb()], verletDist=number['skin'] / 2, avoidSelfInteractionMask=6),
    InteractionLoop([Ig2_Sphere_Sphere_ScGeom(), Ig2_Wall_Sphere_ScGeom()], [physics], [law]),
    NewtonIntegrator(damping=0., gravity=(0, 0, -gz)),
]
O.dt = dt

def compress(part, strain):
    """The path of lammps.in, in which the three walls opposite to the origin move."""
    moving = [O.bodies[n] for n in walls[1::2]]
    for k in range(20):
        rate = strain / (16 * part * dt) if 2 <= k < 18 else 0.
        for axis, (wall, share) in enumerate(zip(moving, (0.5, 0.5, -1.))):
            wall.state.vel = Vector3([rate * share * box[axis] if axis == a else 0. for a in range(3)])
        O.run(part, wait=True)
        sides = [wall.state.pos[axis] for axis, wall in enumerate(moving)]
        volume = sides[0] * sides[1] * sides[2]
        print('pressure', *(O.forces.f(wall.id, sync=True)[axis] * sides[axis] / volume for axis, wall in enumerate(moving)))


start = time.time()
if number['strain'] > 0:
    compress(int(number['check']) // 20, number['strain'])
else:
    O.run(int(number['check']), wait=True)
check_wall_s = time.time() - start
if words['places'] != 'none':
    with open(words['places'], 'w') as out:
        out.writelines('%.17g %.17g %.17g\n' % tuple(O.bodies[n].state.pos) for n in grains)

energy = weight = 0.
for n in movers:
    if n in driven:
        continue
    body = O.bodies[n].state
    force = O.forces.f(n, sync=True) if len(rows[0]) == 4 else sum((O.forces.f(m) for m in O.bodies[n].shape.members), Vector3.Zero)
    # velocities belong to the half step
    velocity = body.vel + dt / 2 * (force / body.mass + Vector3(0, 0, -gz))
    energy += body.mass * velocity.squaredNorm() / 2
    weight += body.mass * gz
O.run(1, wait=True)  # contacts and forces belong to the beginning of this step
spheres = {b.id for b in O.bodies if isinstance(b.shape, Sphere)}
contacts = sum(1 for i in O.interactions if i.id1 in spheres and i.id2 in spheres and i.geom.penetrationDepth > 0)
# force of the grains on the walls
push = -sum(O.forces.f(n)[2] for n in walls)

began = time.time()
O.run(int(number['timed']), wait=True)
wall_s = time.time() - began
print('code=yade spheres=%d wall_s=%.6g check_wall_s=%.6g coordination=%.6g kinetic_energy_J=%.8g wall_force_over_weight=%.8g' %
      (len(rows), wall_s, check_wall_s, 2. * contacts / len(rows), energy, push / (weight or 1)))
sys.stdout.flush()
os._exit(0)
