#include "systems/fusion/correct.hpp"

namespace bris {

void book_corrections(Rows<Bodies, const Force, const Torque, const Correction, FusionWork> bodies) {
    const Vec3 *force = bodies.column<Force>(), *torque = bodies.column<Torque>();
    const CorrectionRow* correction = bodies.column<Correction>();
    double* work = bodies.column<FusionWork>();
    for (Row b = bodies.first(); b < bodies.last(); ++b) {
        const CorrectionRow& c = correction[b];
        work[b] -= 0.5 * (force[b].dot(c.last_shift) + torque[b].dot(c.last_turn));
        if (c.steps > 0) work[b] -= 0.5 * (force[b].dot(c.shift) + torque[b].dot(c.turn));
    }
}

void pull_sensors(Rows<Bodies, const Pull, const Velocity, const StepSpin, Force, Torque, FusionWork> bodies, const Clock& clock) {
    const PullRow* pull = bodies.column<Pull>();
    const Vec3 *velocity = bodies.column<Velocity>(), *spin = bodies.column<StepSpin>();
    Vec3 *force = bodies.column<Force>(), *torque = bodies.column<Torque>();
    double* work = bodies.column<FusionWork>();
    for (Row b = bodies.first(); b < bodies.last(); ++b) {
        work[b] += clock.dt * (pull[b].force.dot(velocity[b]) + pull[b].torque.dot(spin[b]));
        force[b] += pull[b].force;
        torque[b] += pull[b].torque;
    }
}

void turn_corrections(Rows<Bodies, const Correction, Orientation> bodies) {
    const CorrectionRow* correction = bodies.column<Correction>();
    Quat* orientation = bodies.column<Orientation>();
    for (Row b = bodies.first(); b < bodies.last(); ++b)
        if (correction[b].steps > 0) orientation[b] = (exponential_map(correction[b].turn) * orientation[b]).normalized();
}

void shift_corrections(Rows<Bodies, Correction, Position> bodies) {
    CorrectionRow* correction = bodies.column<Correction>();
    Vec3* position = bodies.column<Position>();
    for (Row b = bodies.first(); b < bodies.last(); ++b) {
        CorrectionRow& c = correction[b];
        const bool under_way = c.steps > 0;
        if (under_way) position[b] += c.shift;
        c.last_shift = under_way ? c.shift : Vec3::Zero();
        c.last_turn = under_way ? c.turn : Vec3::Zero();
        c.steps = under_way ? c.steps - 1 : 0;
    }
}

void tell_corrections(Rows<Bodies, const Correction, RigidMotion> bodies, const Clock& clock) {
    const CorrectionRow* correction = bodies.column<Correction>();
    MotionRow* motion = bodies.column<RigidMotion>();
    for (Row b = bodies.first(); b < bodies.last(); ++b) {
        const CorrectionRow& c = correction[b];
        if (c.felt == 0) continue;
        const Vec3 v = c.last_shift / clock.dt, w = c.last_turn / clock.dt;
        motion[b].vx += v.x();
        motion[b].vy += v.y();
        motion[b].vz += v.z();
        motion[b].spin_x += w.x();
        motion[b].spin_y += w.y();
        motion[b].spin_z += w.z();
    }
}

void give_correction(CorrectionRow& row, const Vec3& shift, const Vec3& turn, unsigned steps) {
    row.shift = shift / steps;
    row.turn = turn / steps;
    row.steps = steps;
    row.felt = steps > 1 ? 1 : 0;
}

} // namespace bris
