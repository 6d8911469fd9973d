#include "scenarios/ballast_box/draw_box.hpp"

#include "engine/ordering.hpp"
#include "engine/ranks.hpp"
#include "scenarios/ballast_box/box_scene.hpp"
#include "systems/output/frames.hpp"
#include "systems/slabs/slabs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace bris {

namespace {

constexpr double parked = 2; // m, height above which bodies wait

void draw_view(View view, const std::string& caption, const std::filesystem::path& png) {
    std::erase_if(view.quads, [](const auto& quad) { return quad[0].z() > parked; });
    std::erase_if(view.balls, [](const DrawnBall& ball) { return ball.centre.z() > parked; });
    view.caption = caption;
    draw_picture(png, {&view, 1}, {.azimuth = -1.2, .elevation = 0.15});
}

} // namespace

void draw_box(const World& world, const std::filesystem::path& png, const std::string& caption) {
    const BodyFrame frame = frame_of_bodies(world);
    const auto& sensors = world.resource<BoxBodies>().sensors;
    draw_view(view_of_bodies(world, frame,
                             [&](std::size_t index) {
                                 const auto id = static_cast<std::uint32_t>(frame.ids[index]);
                                 const bool sensor = std::ranges::any_of(
                                     sensors, [&](const BoxSensor& s) { return s.body == id; });
                                 return sensor ? Colour{200, 40, 40} : rock_colour(id);
                             }),
              caption, png);
}

void draw_ranks(const World& world, const std::filesystem::path& png) {
    constexpr std::array<Colour, 6> colours{{{70, 120, 180},
                                             {220, 150, 60},
                                             {90, 160, 90},
                                             {190, 80, 80},
                                             {140, 110, 180},
                                             {120, 120, 120}}};
    const BodyFrame frame = frame_of_bodies(world);
    const std::vector<unsigned> rank = ranks_of_bodies(world);
    const auto rows = rows_by_id(world.column<Bodies, BodyId>());
    draw_view(view_of_bodies(world, frame,
                             [&](std::size_t k) {
                                 const auto id = static_cast<std::uint32_t>(frame.ids[k]);
                                 return colours[rank[rows[id]] % colours.size()];
                             }),
              fmt::format("Ballast box on {} ranks, each in its colour.", Ranks::size()), png);
}

std::vector<Vec3> positions_in_frame(const World& world) {
    return frame_of_bodies(world).positions;
}

void draw_displacements(const World& world, const std::vector<Vec3>& before,
                        const std::filesystem::path& png, const std::string& since) {
    const BodyFrame frame = frame_of_bodies(world);
    const EntityId first = world.resource<BoxBodies>().sensors.front().body; // rocks follow
    std::vector<double> moved(frame.ids.size(), 0), of_rocks;
    for (std::size_t k = 0; k < moved.size(); ++k) {
        moved[k] = (frame.positions[k] - before[k]).norm();
        if (static_cast<EntityId>(frame.ids[k]) >= first) of_rocks.push_back(moved[k]);
    }
    std::ranges::sort(of_rocks);
    const double scale = std::max(of_rocks[of_rocks.size() * 95 / 100], 1e-9);
    draw_view(
        view_of_bodies(
            world, frame,
            [&](std::size_t k) { return scale_colour(std::min(1.0, moved[k] / scale)); }),
        fmt::format("Displacement {}: dark blue 0, yellow {:.2g} mm and more", since, 1e3 * scale),
        png);
}

} // namespace bris
