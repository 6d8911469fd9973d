#include "systems/servo/platen.hpp"

#include "systems/servo/membrane.hpp"

#include <string>

namespace bris {

void count_platen_contacts(Rows<NearPlanes, const NearPair> near,
                           const NearIndex<PlanePairs>& index, Platen& platen) {
    platen.contacts = 0;
    if (!platen.controlled) return;
    index.for_touching([&](Row k) {
        platen.contacts += near.column<NearPair>()[k].other == platen.plane ? 1 : 0;
    });
}

void servo_platen(
    Rows<Planes, const HostRow> planes,
    Rows<Bodies, const Force, const PrunedAt, Position, Velocity, DisplacementBound> bodies,
    Platen& platen, const Clock& clock, Health& health) {
    const Row host = planes.column<HostRow>()[platen.plane];
    const double area = platen.area;
    // the grains push the platen up
    const double push = bodies.column<Force>()[host].z() - platen.pull;
    platen.pressure = push / area;
    if (platen.controlled) {
        const double aim = platen.aim.next(platen.target_pressure);
        const double stiffness =
            platen.contact_stiffness * (1 + static_cast<double>(platen.contacts));
        const double load = platen.axial_load.force(clock.time(), area);
        platen.wanted = aim + load / area;
        ServoMotion servo{platen.stiffness, platen.damping, platen.largest_step, clock.dt,
                          platen.axial_load.mass};
        platen.speed = servo.next(platen.speed, aim * area + load - push, stiffness);
    }
    Vec3& position = bodies.column<Position>()[host];
    bodies.column<Velocity>()[host] = Vec3(0, 0, -platen.speed);
    position.z() -= platen.speed * clock.dt;
    bodies.column<DisplacementBound>()[host] = (position - bodies.column<PrunedAt>()[host]).norm();
    if (position.z() > 0 || health.bad) return; // a height that is not a number does not return
    health.bad = true;
    health.what = "the platen has reached the bottom: expected grains that carry it, found none; "
                  "its pressure is " +
                  std::to_string(platen.pressure) + " Pa";
}

void accumulate_platen_work(Rows<Planes, const HostRow> planes,
                            Rows<Bodies, const Force, const Velocity, BoundaryWork> bodies,
                            const Platen& platen, const Clock& clock) {
    const Row host = planes.column<HostRow>()[platen.plane];
    bodies.column<BoundaryWork>()[host] -=
        0.5 * clock.dt * bodies.column<Force>()[host].dot(bodies.column<Velocity>()[host]);
}

} // namespace bris
