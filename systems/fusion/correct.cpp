#include "systems/fusion/correct.hpp"

namespace bris {

void accumulate_correction_work(
    Rows<Bodies, const Guided, const Force, const Torque, const Correction, FusionWork> bodies) {
    const Vec3 *force = bodies.column<Force>(), *torque = bodies.column<Torque>();
    const CorrectionRow* correction = bodies.column<Correction>();
    double* work = bodies.column<FusionWork>();
    for_guided(bodies, [&](Row b) {
        const CorrectionRow& c = correction[b];
        work[b] -= 0.5 * (force[b].dot(c.last_shift) + torque[b].dot(c.last_turn));
        if (c.steps > 0) work[b] -= 0.5 * (force[b].dot(c.shift) + torque[b].dot(c.turn));
    });
}

void apply_correction_rotation(Rows<Bodies, const Guided, const Correction, Orientation> bodies) {
    const CorrectionRow* correction = bodies.column<Correction>();
    Quat* orientation = bodies.column<Orientation>();
    for_guided(bodies, [&](Row b) {
        if (correction[b].steps > 0)
            orientation[b] = (exponential_map(correction[b].turn) * orientation[b]).normalized();
    });
}

void apply_correction_displacement(
    Rows<Bodies, Correction, const Nudging, Guided, Position> bodies) {
    const NudgingRow* nudging = bodies.column<Nudging>();
    std::uint32_t* guided = bodies.column<Guided>();
    CorrectionRow* correction = bodies.column<Correction>();
    Vec3* position = bodies.column<Position>();
    for_guided(bodies, [&](Row b) {
        CorrectionRow& c = correction[b];
        const bool pending = c.steps > 0;
        if (pending) position[b] += c.shift;
        c.last_shift = pending ? c.shift : Vec3::Zero();
        c.last_turn = pending ? c.turn : Vec3::Zero();
        c.steps = pending ? c.steps - 1 : 0;
        guided[b] = pending || nudging[b].is_active() ? 1 : 0;
    });
}

void apply_correction_velocity(Rows<Bodies, const Guided, const Correction, RigidMotion> bodies,
                               const Clock& clock) {
    const CorrectionRow* correction = bodies.column<Correction>();
    MotionRow* motion = bodies.column<RigidMotion>();
    for_guided(bodies, [&](Row b) {
        const CorrectionRow& c = correction[b];
        if (c.as_motion == 0) return;
        const Vec3 v = c.last_shift / clock.dt, w = c.last_turn / clock.dt;
        motion[b].vx += v.x();
        motion[b].vy += v.y();
        motion[b].vz += v.z();
        motion[b].omega_x += w.x();
        motion[b].omega_y += w.y();
        motion[b].omega_z += w.z();
    });
}

void set_correction(CorrectionRow& row, std::uint32_t& guided, const Vec3& shift, const Vec3& turn,
                    unsigned steps) {
    row.shift = shift / steps;
    row.turn = turn / steps;
    row.steps = steps;
    row.as_motion = steps > 1 ? 1 : 0;
    guided = 1;
}

} // namespace bris
