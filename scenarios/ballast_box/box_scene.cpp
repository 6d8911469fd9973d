#include "scenarios/ballast_box/box_scene.hpp"

#include "components/kinds.hpp"
#include "components/settings.hpp"
#include "components/sphere.hpp"
#include "engine/errors.hpp"
#include "engine/random.hpp"
#include "scenarios/rocks/own_rocks.hpp"
#include "scenarios/specimens/facet_bodies.hpp"
#include "scenarios/specimens/scene.hpp"
#include "systems/broadphase/lists.hpp"
#include "systems/output/quantities.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace bris {

namespace {

constexpr double parked = 5;                                 // m, height where bodies wait
constexpr double guide_stiffness = 5e7, guide_damping = 2e4; // N/m, N s/m
constexpr double sensor_size = 0.045;                        // m, sieve size of a sensor rock

/// Springs that hold a body against translation along x and y and rotation about z, and, by rods of
/// 1 m, against rotation about x and y.
void add_guides(World& world, EntityId body, bool along_y, bool about_y) {
    const auto guide = [&](const Vec3& point, const Vec3& axis) {
        add_guide(world, body, point, axis, guide_stiffness, guide_damping);
    };
    for (const double end : {-1.0, 1.0}) {
        guide(Vec3(0, end, 0), Vec3::UnitX());
        if (along_y) guide(Vec3(0, 0, end), Vec3::UnitY());
        if (about_y) guide(Vec3(0, 0, end), Vec3::UnitX());
    }
}

/// Plates of the subgrade, each on four springs that carry its weight when it lies at z = 0.
void add_subgrade(World& world, const BallastBox& box, const BoxSizes& s, BoxBodies& bodies,
                  std::uint32_t material) {
    constexpr double thickness = 0.05, moving_depth = 0.15, soil_density = 1900, margin = 0.1;
    const auto along_y = static_cast<int>(std::ceil(s.across / 0.3)),
               along_x = std::max(1, static_cast<int>(std::round(s.width / 0.3)));
    const double lx = s.width / along_x, ly = s.across / along_y;
    for (int i = 0; i < along_x; ++i)
        for (int j = 0; j < along_y; ++j) {
            // the outer plates reach under the sides, so that no rock falls between
            const double x0 = i == 0 ? -margin : i * lx,
                         x1 = i + 1 == along_x ? s.width + margin : (i + 1) * lx,
                         y0 = j == 0 ? -margin : j * ly,
                         y1 = j + 1 == along_y ? s.across + margin : (j + 1) * ly;
            const double mass = soil_density * lx * ly * moving_depth,
                         stiffness = box.subgrade_modulus * lx * ly / 4,
                         damping = box.subgrade_damping * std::sqrt(stiffness * mass);
            const Vec3 centre((x0 + x1) / 2, (y0 + y1) / 2, -thickness / 2),
                middle(i * lx + lx / 2, j * ly + ly / 2, -thickness / 2);
            const EntityId plate = add_block(world, centre, Quat(Quat::Identity()),
                                             Vec3(x1 - x0, y1 - y0, thickness), mass, material);
            const double sunk = mass * 9.81 / (4 * stiffness);
            for (const double dx : {-0.5, 0.5})
                for (const double dy : {-0.5, 0.5})
                    for (int axis = 0; axis < 3; ++axis) {
                        const Vec3 corner = middle + Vec3(dx * lx, dy * ly, 0);
                        add_patch(
                            world, plate,
                            {.point = corner - centre,
                             .anchor = corner + (axis == 2 ? Vec3(0, 0, sunk) : Vec3(Vec3::Zero())),
                             .axis = Vec3::Unit(axis),
                             .stiffness = stiffness,
                             .damping = damping});
                    }
            bodies.subgrade.push_back(plate);
        }
}

/// A block in front of the wall, pushed against a stop by the pressure and held by guides: it is
/// as stiff as its stop while the ballast pushes with less than the pressure, and gives way beyond.
void add_bladder(World& world, const BallastBox& box, const BoxSizes& s, BoxBodies& bodies,
                 std::uint32_t material) {
    constexpr double stop_stiffness = 1e9, mass = 100;
    const Vec3 size(s.width + 0.2, s.bladder_depth, s.bladder_top - s.bladder_low),
        centre(s.width / 2, s.bladder_face() + s.bladder_depth / 2,
               (s.bladder_low + s.bladder_top) / 2);
    const EntityId body = add_block(world, centre, Quat(Quat::Identity()), size, mass, material);
    add_guides(world, body, false, true);
    for (const double end : {-1.0, 1.0}) // rods along x: no rotation about y and z
        add_guide(world, body, Vec3(end, 0, 0), Vec3::UnitZ(), guide_stiffness, guide_damping);
    for (const double end : {-1.0, 1.0}) // and about x
        add_guide(world, body, Vec3(0, end, 0), Vec3::UnitZ(), guide_stiffness, guide_damping);
    // the stop pushes along +y once the bladder is full
    const double force = box.bladder_pressure * s.bladder_height * s.width;
    add_patch(world, body,
              {.anchor = centre + Vec3(0, force / stop_stiffness, 0),
               .axis = Vec3::UnitY(),
               .stiffness = stop_stiffness,
               .damping = std::sqrt(stop_stiffness * mass),
               .one_sided = true});
    add_load(world, body, {.force = Vec3(0, -force, 0)});
    bodies.bladder = body;
}

void add_tie_bodies(World& world, const BoxSizes& s, BoxBodies& bodies, std::uint32_t material) {
    const double mass = tie_mass * s.share;
    for (const double x : s.ties) {
        const Vec3 centre(x, s.tie_centre(), parked);
        const EntityId tie =
            add_block(world, centre, Quat(Quat::Identity()), s.tie, mass, material);
        add_guides(world, tie, true, s.ties.size() == 1);
        add_load(world, tie,
                 {.force = Vec3(0, 0, -1),
                  .point = Vec3(0, s.load_place() - s.tie_centre(), s.tie.z() / 2),
                  .history = {.mean = 0}});
        bodies.ties.push_back(tie);
    }
}

/// Plates that compact the lifts: those of the first one reach to the wall, those of the others to
/// the bladder. A large surface has several, since a single rigid plate would rest on few rocks.
void add_plates(World& world, const BoxSizes& s, BoxBodies& bodies, std::uint32_t material) {
    constexpr double mass_of_area = 150;                   // kg/m2
    constexpr double along = 1.3, across = 1.7;            // m, usual sides
    constexpr double margin = 0.1, gap = 1e-3, rim = 0.01; // m
    for (const bool first : {true, false}) {
        const double depth = (first ? s.across : s.bladder_face()) - 2 * rim;
        const int columns = std::max(1, static_cast<int>(std::round(s.width / along))),
                  rows = std::max(1, static_cast<int>(std::round(depth / across)));
        const double lx = s.width / columns, ly = depth / rows;
        for (int i = 0; i < columns; ++i)
            for (int j = 0; j < rows; ++j) {
                const double x0 = i == 0 ? -margin : i * lx + gap,
                             x1 = i + 1 == columns ? s.width + margin : (i + 1) * lx - gap,
                             y0 = rim + (j == 0 ? 0 : j * ly + gap),
                             y1 = rim + (j + 1 == rows ? depth : (j + 1) * ly - gap);
                const Vec3 size(x1 - x0, y1 - y0, plate_thickness);
                const EntityId plate =
                    add_block(world, Vec3((x0 + x1) / 2, (y0 + y1) / 2, parked + (first ? 1 : 1.5)),
                              Quat(Quat::Identity()), size, mass_of_area * lx * ly, material);
                add_guides(world, plate, true, true);
                add_load(world, plate, {.force = Vec3(0, 0, -1), .history = {.mean = 0}});
                bodies.plates[first ? 0 : 1].push_back({plate, Vec3(x0, y0, 0), Vec3(x1, y1, 0)});
            }
    }
}

/// Area (m2) of a course: the bladder stands on the first one.
double area_of(const BoxSizes& s, std::size_t course) {
    return s.width * (course == 0 ? s.across : s.bladder_face());
}

Clump rock_of(const BoxBodies& bodies, const PlannedRock& planned) {
    const Clump& shape = bodies.shapes[planned.shape];
    return scaled(shape, planned.sieve / shape.sieve);
}

/// Rocks of all courses, whose ids begin with `first`.
void plan_rocks(const BallastBox& box, const BoxSizes& s, BoxBodies& bodies, EntityId first,
                std::uint64_t seed) {
    const Grading grading = grading_named(box.grading);
    std::array<double, courses.size()> wanted{};
    double total = 0;
    for (std::size_t c = 0; c < courses.size(); ++c)
        total += wanted[c] = (1 - box.porosity) * courses[c].thickness * area_of(s, c);
    const double cubed = std::pow(box.scale(), 3);
    require_countable(grading, bodies.shapes, total / cubed, box.smallest_rock, "--smallest-rock");
    std::size_t count = 1000;
    RockSample sample;
    for (int tries = 0; tries < 4; ++tries) { // the mean volume hardly depends on the number
        sample = sample_rocks(grading, bodies.shapes, count, seed, box.smallest_rock);
        count = static_cast<std::size_t>(std::max(
            8.0, std::round(static_cast<double>(count) * total / (cubed * sample.solid_volume))));
    }
    bodies.truncated_fraction = sample.truncated_fraction;
    std::size_t course = 0;
    double filled = 0;
    for (const auto& [shape, sieve] : sample.rocks) {
        const PlannedRock planned{shape, box.scale() * sieve};
        const Clump rock = rock_of(bodies, planned);
        const double least_width = 2.1 * rock.bounding_radius;
        require(least_width < s.width,
                fmt::format("--width: expected more than {:.3f} m, 1.05 times the largest rock, "
                            "found {:g} m (--rock-scale {:g})",
                            least_width, s.width, box.scale()));
        if (filled >= wanted[course] && course + 1 < courses.size()) {
            ++course;
            filled = 0;
        }
        bodies.rocks[course].push_back(first++);
        bodies.planned[course].push_back(planned);
        filled += rock.volume;
    }
}

/// Sensor rocks where the report has them: two (cubes) under the rail seat, and (angular) ones
/// under the middle and the end of a tie and between two ties (in a bay beside its mirror side,
/// which is there); 5 and 25 cm below the ties. A slice has none between ties.
void add_sensors(World& world, const BallastBox& box, const BoxSizes& s, BoxBodies& bodies,
                 const std::vector<Clump>& library, std::uint64_t seed) {
    struct Site {
        const char* name;
        double x, y;
    };
    const auto shapes = sensor_shapes_named(box.sensor_shape, library, "--sensor-shape");
    const double tie = s.ties[s.loaded[0]], seat = s.middle + s.rail_seat;
    std::vector<Site> sites{{"rail_seat", tie, seat},
                            {"middle", tie, s.middle > 0 ? s.middle : 0.06},
                            {"end", tie, s.tie_end() - 0.03}};
    if (s.ties.size() > 1) sites.push_back({"between", s.width / 2, seat});
    if (box.is_bay()) sites.push_back({"between", 0, seat});
    for (const Site& site : sites)
        for (const std::size_t course : {std::size_t{0}, std::size_t{2}}) {
            const Clump& shape = shapes[bodies.sensors.size() / 2 % shapes.size()];
            const Clump rock = scaled(shape, sensor_size / shape.sieve);
            const auto in_library = std::ranges::find(library, shape.name, &Clump::name);
            const auto number = static_cast<double>(bodies.sensors.size());
            const EntityId id =
                add_clump(world, rock, static_cast<std::uint32_t>(in_library - library.begin()),
                          Vec3(0.2 * number, -1, parked + 3),
                          Random(seed, 6000 + bodies.sensors.size()).rotation(), bodies.shell);
            value_of<MotionOf>(world, id) = static_cast<std::uint32_t>(Motion::fixed);
            bodies.sensors.push_back({fmt::format("{}_{}", site.name, course == 0 ? "25cm" : "5cm"),
                                      id, Vec3(site.x, site.y, 0), course});
            if (!box.is_dynamic()) continue;
            ImuModel model = imu_preset(box.imu);
            model.rate = box.sampling_rate;
            model.bandwidth = std::min(model.bandwidth, 0.4 * model.rate);
            add_recorder(world, id, model, Vec3(0, 0, -9.81), seed);
        }
}

} // namespace

World make_box_world(const BallastBox& box, std::uint64_t seed) {
    const BoxSizes s = box_sizes(box);
    const std::vector<Clump> library = clumps_of(box.clumps);
    World world = make_world(Grains::clumps);
    BoxBodies bodies;
    auto& materials = world.resource<Materials>();
    const RockMaterial stone = read_rock_material(box.material);
    bodies.wet_friction = 1 - stone.wet_friction_loss;
    Material rock = stone.material("rock");
    rock.friction *= box.friction_factor;
    rock.normal_stiffness *= box.stiffness_factor;
    rock.shear_stiffness *= box.stiffness_factor;
    bodies.rock = materials.add(rock);
    Material concrete = rock, side = rigid_material(0);
    concrete.name = "concrete";
    concrete.normal_stiffness = concrete.shear_stiffness = 1e8;
    concrete.friction = std::max(rock.friction, 0.6);
    const auto hard = materials.add(concrete);
    side.name = "mirror";
    side.restitution = rock.restitution;
    const auto mirror = materials.add(side);
    bodies.shell = bodies.rock;
    if (box.is_bay()) {
        rock.name = "shell";
        bodies.shell = materials.add(rock);
    }
    bodies.hard = materials.list;

    add_subgrade(world, box, s, bodies, hard);
    const EntityId sides = add_boundary(world, Vec3::Zero(), box.is_full() ? hard : mirror);
    add_plane(world, sides, Vec3::Zero(), Vec3::UnitX());
    add_plane(world, sides, Vec3(s.width, 0, 0), -Vec3::UnitX());
    add_plane(world, sides, Vec3::Zero(), Vec3::UnitY());
    const EntityId wall = add_boundary(world, Vec3(0, s.across, 0), hard);
    add_plane(world, wall, Vec3::Zero(), -Vec3::UnitY());
    add_bladder(world, box, s, bodies, hard);
    add_plates(world, s, bodies, hard);
    add_tie_bodies(world, s, bodies, hard);
    add_sensors(world, box, s, bodies, library, seed);
    bodies.shapes = rocks_among(library);
    plan_rocks(box, s, bodies, static_cast<EntityId>(world.table<Bodies>().size()), seed);
    value_of<Position>(world, bodies.bladder).z() += parked + 2;
    std::vector<EntityId> waiting = bodies.ties;
    waiting.push_back(bodies.bladder);
    for (const auto& plates : bodies.plates)
        for (const CompactionPlate& plate : plates) waiting.push_back(plate.body);
    for (const EntityId body : waiting)
        value_of<MotionOf>(world, body) = static_cast<std::uint32_t>(Motion::fixed);

    auto& limits = world.resource<Limits>();
    limits.overlap = 0.9; // rocks are soft while the bed is made, and a plate first meets a few
    limits.low = Vec3(-1.5, -1.5, -0.3);
    limits.high = Vec3(s.width + 1.5, s.across + 1.5, 12);
    world.add_resource<Gravity>();
    world.add_resource(std::move(bodies));
    world.add_resource<BoxState>();
    for (std::size_t course = 0; course < courses.size(); ++course) add_course(world, course, seed);
    return world;
}

void add_course(World& world, std::size_t course, std::uint64_t seed) {
    constexpr std::size_t side = 60; // rocks, of the layers in which they wait
    constexpr double apart = 0.2;    // m, more than the largest rock
    const auto& bodies = world.resource<BoxBodies>();
    const EntityId first = bodies.rocks.front().front();
    for (std::size_t i = 0; i < bodies.rocks[course].size(); ++i) {
        const PlannedRock& planned = bodies.planned[course][i];
        const std::size_t k = bodies.rocks[course][i] - first;
        const Vec3 layer(static_cast<double>(k % side), static_cast<double>(k / side % side),
                         static_cast<double>(k / (side * side)));
        add_clump(world, rock_of(bodies, planned), static_cast<std::uint32_t>(planned.shape),
                  Vec3(Vec3(0, 0, parked + 3) + apart * layer), Random(seed, 7000 + k).rotation(),
                  bodies.rock, Motion::fixed);
    }
}

void remove_later_courses(World& world) {
    const EntityId first = world.resource<BoxBodies>().rocks[1].front();
    const auto parents = world.column<Spheres, ParentId>();
    world.table<Spheres>().resize(
        static_cast<std::size_t>(std::ranges::lower_bound(parents, first) - parents.begin()));
    world.table<Bodies>().resize(first);
}

void set_materials(World& world, const MakingMaterials& making) {
    auto& materials = world.resource<Materials>();
    const auto& full = world.resource<BoxBodies>().hard;
    for (std::size_t k = 0; k < full.size(); ++k) {
        const bool rigid = full[k].normal_stiffness >= 1e20;
        const double factor = rigid ? 1 : making.softness;
        materials.list[k].normal_stiffness = full[k].normal_stiffness * factor;
        materials.list[k].shear_stiffness = full[k].shear_stiffness * factor;
        materials.list[k].friction = full[k].friction * making.friction;
        materials.list[k].restitution = std::min(full[k].restitution, making.most_restitution);
    }
    materials.mix();
}

namespace {

void put(World& world, EntityId body, const Vec3& position, Motion motion) {
    const Row row = row_of_body(world, body);
    Table& bodies = world.table<Bodies>();
    bodies.column<Position>()[row] = position;
    bodies.column<MotionOf>()[row] = static_cast<std::uint32_t>(motion);
    bodies.column<Velocity>()[row].setZero();
    bodies.column<Acceleration>()[row].setZero();
    set_angular_velocity(world, body, Vec3::Zero());
    invalidate_lists(world);
}

/// Calls visit(centre, radius, body row) for the spheres of the free rocks.
template <class Visit>
void visit_spheres(const World& world, Visit&& visit) {
    const Table& bodies = world.table<Bodies>();
    std::vector<Row> row_of(bodies.size());
    for (Row b = 0; b < bodies.size(); ++b) row_of[bodies.column<BodyId>()[b]] = b;
    const auto ball = world.column<Spheres, LocalBall>();
    const auto parent = world.column<Spheres, ParentId>();
    for (std::size_t k = 0; k < ball.size(); ++k) {
        const Row b = row_of[parent[k]];
        if (bodies.column<MotionOf>()[b] != static_cast<std::uint32_t>(Motion::free)) continue;
        visit(Vec3(bodies.column<Position>()[b] + bodies.column<Orientation>()[b] * ball[k].centre),
              ball[k].radius, b);
    }
}

} // namespace

void release(World& world, EntityId body, const Vec3& position) {
    put(world, body, position, Motion::free);
}
void park(World& world, EntityId body, const Vec3& position) {
    put(world, body, position, Motion::fixed);
}

void place_bladder(World& world, const BoxSizes& s) {
    const EntityId bladder = world.resource<BoxBodies>().bladder;
    const double surface =
        surface_height(world, Vec3(0, s.bladder_face(), 0), Vec3(s.width, s.across, 0), 0);
    const double raised = std::max(0.0, surface + 1e-3 - s.bladder_low);
    for (SpringPatch& p :
         world.resource<SpringPatches>().of_body[value_of<PatchesOf>(world, bladder) - 1])
        p.anchor.z() += raised;
    release(world, bladder,
            Vec3(s.width / 2, s.bladder_face() + s.bladder_depth / 2,
                 (s.bladder_low + s.bladder_top) / 2 + raised));
}

double surface_height(const World& world, double x, double y, double radius, double least) {
    double height = least;
    visit_spheres(world, [&](const Vec3& c, double r, Row) {
        if (std::hypot(c.x() - x, c.y() - y) < radius + r) height = std::max(height, c.z() + r);
    });
    return height;
}

double surface_height(const World& world, const Vec3& low, const Vec3& high, double least) {
    double height = least;
    visit_spheres(world, [&](const Vec3& c, double r, Row) {
        if (c.x() > low.x() - r && c.x() < high.x() + r && c.y() > low.y() - r &&
            c.y() < high.y() + r)
            height = std::max(height, c.z() + r);
    });
    return height;
}

void check_tie(const World& world, const BoxSizes& s, double x, double level, double surface) {
    const double limit = world.resource<Limits>().overlap;
    const Vec3 centre(x, s.tie_centre(), level + s.tie.z() / 2);
    visit_spheres(world, [&](const Vec3& c, double r, Row b) {
        const Vec3 outside = (c - centre).cwiseAbs() - 0.5 * s.tie;
        const double inside = outside.maxCoeff(); // of a centre within the tie, below 0
        const double distance = inside < 0 ? inside : outside.cwiseMax(0).norm();
        require(r - distance <= limit * r,
                fmt::format("--tie-level: expected ties clear of the rocks, above {:.3f} m, "
                            "found one at {:g} m that overlaps rock {} by {:.4f} m",
                            surface, level, world.column<Bodies, BodyId>()[b], r - distance));
    });
}

} // namespace bris
