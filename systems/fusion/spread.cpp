#include "systems/fusion/spread.hpp"

#include "components/body.hpp"
#include "components/kinds.hpp"
#include "components/sensor.hpp"
#include "engine/ordering.hpp"
#include "systems/fusion/contact_network.hpp"
#include "systems/fusion/correct.hpp"

#include <algorithm>
#include <vector>

namespace bris {

namespace {

/// Free sensor bodies with a pending correction, by id.
std::vector<Row> corrected_bodies(const World& world) {
    const auto row = rows_by_id(world.column<Bodies, BodyId>());
    const auto motion = world.column<Bodies, MotionOf>();
    const auto correction = world.column<Bodies, Correction>();
    const auto host = world.column<Sensors, SensorHost>();
    std::vector<EntityId> ids(host.begin(), host.end());
    std::ranges::sort(ids);
    std::vector<Row> bodies;
    for (const EntityId id : ids)
        if (motion[row[id]] == static_cast<std::uint32_t>(Motion::free) &&
            correction[row[id]].steps > 0)
            bodies.push_back(row[id]);
    return bodies;
}

} // namespace

double spread_corrections(World& world, const SpreadSettings& settings) {
    std::vector<Row> bodies = corrected_bodies(world);
    if (bodies.empty()) return 0;
    const std::size_t corrected = bodies.size();
    SpringNetwork network{{}, joints_of(world, bodies, Others::join)};
    double mean_stiffness = 0;
    for (const Joint& j : network.joints)
        mean_stiffness += j.kn / static_cast<double>(network.joints.size());
    if (network.joints.empty()) mean_stiffness = 1; // any value will do

    const auto correction = world.column<Bodies, Correction>();
    const auto guided = world.column<Bodies, Guided>();
    const auto radius = world.column<Bodies, BoundingRadius>();
    double steps = 0;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        const double arm2 = radius[bodies[i]] * radius[bodies[i]]; // converts rotations to lengths
        const CorrectionRow& c = correction[bodies[i]];
        Hold& hold = network.holds.emplace_back();
        hold.stiffness << Vec3::Constant(mean_stiffness), Vec3::Constant(mean_stiffness * arm2);
        if (i < corrected) {
            // two springs hold it: at its present pose and at its correction
            const double both = settings.float_free + settings.hold;
            hold.wanted << c.steps * c.shift, c.steps * c.turn;
            hold.wanted *= settings.hold / both;
            hold.stiffness *= both;
            steps = std::max(steps, c.steps);
        } else
            hold.stiffness *= settings.float_free;
    }
    const auto u = motion_of_least_energy(network, settings.tolerance);
    for (std::size_t i = 0; i < bodies.size(); ++i)
        set_correction(correction[bodies[i]], guided[bodies[i]], u[i].head<3>(), u[i].tail<3>(),
                       static_cast<unsigned>(steps));
    return energy_of_joints(network, u);
}

double energy_of_corrections(const World& world) {
    std::vector<Row> bodies = corrected_bodies(world);
    const SpringNetwork network{{}, joints_of(world, bodies, Others::stay)};
    std::vector<Vector6> motion;
    for (const Row body : bodies) {
        const CorrectionRow& c = world.column<Bodies, Correction>()[body];
        motion.emplace_back() << c.steps * c.shift, c.steps * c.turn;
    }
    return energy_of_joints(network, motion);
}

} // namespace bris
