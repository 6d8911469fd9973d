#include "scenarios/ballast_box/draw_box.hpp"

#include "scenarios/ballast_box/box_scene.hpp"
#include "systems/output/frames.hpp"

#include <algorithm>

namespace bris {

void draw_box(const World& world, const std::filesystem::path& png, const std::string& caption) {
    const BodyFrame frame = frame_of_bodies(world);
    const auto& sensors = world.resource<BoxBodies>().sensors;
    View view = view_of_bodies(world, frame, [&](std::size_t index) {
        const auto id = static_cast<std::uint32_t>(frame.ids[index]);
        const bool sensor =
            std::ranges::any_of(sensors, [&](const BoxSensor& s) { return s.body == id; });
        return sensor ? Colour{200, 40, 40} : rock_colour(id);
    });
    std::erase_if(view.quads, [](const auto& quad) { return quad[0].z() > 2; }); // parked
    std::erase_if(view.balls, [](const DrawnBall& ball) { return ball.centre.z() > 2; });
    view.caption = caption;
    draw_picture(png, {&view, 1}, {.azimuth = -1.2, .elevation = 0.15});
}

} // namespace bris
