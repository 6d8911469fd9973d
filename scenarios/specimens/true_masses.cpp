#include "scenarios/specimens/true_masses.hpp"

#include "components/body.hpp"
#include "components/kinds.hpp"
#include "systems/broadphase/lists.hpp"
#include "systems/contact/mass_scaling.hpp"
#include "systems/contact/stable_step.hpp"

#include <algorithm>

namespace bris {

double restore_masses(World& world) {
    Table& bodies = world.table<Bodies>();
    const auto motion = bodies.column<MotionOf>();
    const auto mass = bodies.column<Mass>();
    InertialMasses masses(bodies);
    for (Row b = 0; b < bodies.size(); ++b)
        if (motion[b] == static_cast<std::uint32_t>(Motion::free)) masses.set(b, mass[b], 1);
    show_velocities(world); // and masses: see scale_masses
    return std::min(stable_step(world), stable_step_of_first_contact(world));
}

} // namespace bris
