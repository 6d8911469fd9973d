#include "scenarios/ballast_box/shells.hpp"

#include "components/kinds.hpp"
#include "scenarios/ballast_box/box_scene.hpp"
#include "scenarios/specimens/scene.hpp"

namespace bris {

void change_shells(World& world, const BallastBox& box) {
    auto& bodies = world.resource<BoxBodies>();
    Material& shell = world.resource<Materials>().list[bodies.shell];
    if (box.sensor_friction >= 0) bodies.hard[bodies.shell].friction = box.sensor_friction;
    if (box.sensor_density <= 0 || box.sensor_density == shell.density) return;
    const double factor = box.sensor_density / shell.density;
    for (const BoxSensor& sensor : bodies.sensors) {
        value_of<Mass>(world, sensor.body) *= factor;
        value_of<InertialMass>(world, sensor.body) *= factor;
        value_of<Inertia>(world, sensor.body) *= factor;
        value_of<InertialInertia>(world, sensor.body) *= factor;
    }
    shell.density = box.sensor_density;
}

} // namespace bris
