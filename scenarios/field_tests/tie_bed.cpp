#include "scenarios/field_tests/tie_bed.hpp"

#include "components/fouling.hpp"
#include "components/kinds.hpp"
#include "components/settings.hpp"
#include "engine/errors.hpp"
#include "scenarios/specimens/facet_bodies.hpp"
#include "scenarios/specimens/rock_material.hpp"
#include "scenarios/specimens/scene.hpp"
#include "scenarios/specimens/start.hpp"
#include "systems/fields/fouling.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace bris {

namespace {

constexpr double behind = 0.15, beyond = 0.3; // m, of ballast behind the tie, beyond the shoulder
constexpr double loose_porosity = 0.58;       // of the mould in which rocks grow
constexpr double rim = 0.05;                  // m, by which the plate reaches beyond the mould
constexpr double concrete_stiffness = 1e8;    // N/m
constexpr double guide_stiffness = 5e7, guide_damping = 2e3; // N/m, N s/m

/// Length (m) of the mould along the tie.
double mould_length(const TieBed& bed) { return behind + bed.tie_length + bed.shoulder + beyond; }
/// y (m) of the middle of the tie, in a mould about the z axis.
double tie_middle(const TieBed& bed) {
    return -0.5 * mould_length(bed) + behind + 0.5 * bed.tie_length;
}

/// Springs that leave the tie free along z and to pitch about x, as the mirror does; one pushes it
/// along y (the first patch).
void guide_tie(World& world, EntityId tie, const TieBed& bed) {
    const auto guide = [&](const Vec3& point, const Vec3& axis) {
        add_guide(world, tie, point, axis, guide_stiffness, guide_damping);
    };
    guide(Vec3(0, -0.5 * bed.tie_length, 0), Vec3::UnitY());
    for (const double end : {-1.0, 1.0}) {
        guide(Vec3(0, end, 0), Vec3::UnitX());
        guide(Vec3(0, 0, end), Vec3::UnitX());
    }
}

} // namespace

void check_tie_bed(const TieBed& bed) {
    check_fouling(bed.fouling);
    auto sorted = bed.vci;
    std::ranges::sort(sorted);
    require(!bed.vci.empty() && std::ranges::adjacent_find(sorted) == sorted.end(),
            "--vci: expected one or more different values, found none or equal ones");
    require(sorted.back() == 0 || !bed.fouling.any(),
            "--vci: expected no --fouling-p4, --fouling-file and --saturation with values above "
            "0, found them");
    require(bed.spacing >= 1.5 * bed.tie_width,
            fmt::format("--spacing: expected at least 1.5 times --tie-width, {:g} m, found {:g} m",
                        1.5 * bed.tie_width, bed.spacing));
    require(bed.interval <= bed.displacement / 10,
            fmt::format("--interval: expected at most a tenth of --displacement, {:g} m, found "
                        "{:g} m",
                        bed.displacement / 10, bed.interval));
}

Simulation make_tie_bed(const TieBed& bed, std::uint64_t seed, unsigned threads) {
    check_tie_bed(bed);
    const std::vector<Clump> clumps = rocks_among(clumps_of(bed.rocks.clumps));
    const double length = mould_length(bed), width = bed.width(),
                 tie_volume = 0.5 * bed.tie_width * bed.tie_length * bed.tie_height,
                 height = bed.base + bed.tie_height;
    const RockSample sample =
        sample_of_volume(bed.rocks, clumps,
                         (1 - bed.porosity - 0.02) * (length * width * height - tie_volume), seed);
    double across = 0; // of the largest rock
    for (const RockChoice& rock : sample.rocks)
        across = std::max(across, 2 * clumps[rock.clump].bounding_radius * rock.sieve /
                                      clumps[rock.clump].sieve);
    const double crib = 0.5 * (bed.spacing - bed.tie_width);
    require(across < crib, fmt::format("--spacing: expected half a crib wider than the largest "
                                       "rock, {:.3f} m across (--rock-scale), found {:.3f} m",
                                       across, crib));

    World world = make_world(Grains::clumps);
    auto& materials = world.resource<Materials>();
    const Material rock = read_rock_material(bed.material).material("rock");
    const auto rough = materials.add(rock);
    Material concrete = rock, side = rock;
    concrete.name = "concrete";
    concrete.normal_stiffness = concrete.shear_stiffness = concrete_stiffness;
    const auto hard = materials.add(concrete);
    side.name = "mirror";
    side.friction = 0;
    const auto mirror = materials.add(side);
    const double y = tie_middle(bed), half = 0.5 * bed.tie_length;
    add_rock_bed(world,
                 {.size = Vec3(width, length, height),
                  .porosity = bed.porosity,
                  .tolerance = bed.porosity_tolerance,
                  .pressure = bed.preparation_pressure,
                  .core_low = Vec3(-0.4 * width, y - 0.9 * half, 0.2 * bed.base),
                  .core_high = Vec3(0.4 * width, y + 0.9 * half, 0.8 * bed.base),
                  .seed = seed},
                 clumps, sample, rough, rim);
    // a loose bed is so much higher; the tie sinks as it is pressed together
    const double loose = (1 - bed.porosity) / (1 - loose_porosity);
    const Vec3 size(bed.tie_width, bed.tie_length, bed.tie_height);
    const EntityId tie =
        add_block(world, Vec3(-0.5 * width, y, loose * bed.base + 0.5 * bed.tie_height),
                  Quat(Quat::Identity()), size, 0.5 * bed.tie_mass, hard);
    guide_tie(world, tie, bed);
    add_tie(world, tie, size, tie_volume);

    const EntityId sides = add_boundary(world, Vec3::Zero(), mirror);
    for (const double end : {-1.0, 1.0}) {
        add_plane(world, sides, Vec3(0.5 * end * width, 0, 0), -end * Vec3::UnitX());
        add_plane(world, sides, Vec3(0, 0.5 * end * length, 0), -end * Vec3::UnitY());
    }
    const EntityId floor = add_boundary(world, Vec3::Zero(), rough);
    add_plane(world, floor, Vec3::Zero(), Vec3::UnitZ());
    auto& limits = world.resource<Limits>();
    limits.low -= Vec3::Constant(length);
    limits.high += Vec3::Constant(length);
    world.add_resource(TieState{});
    return start(std::move(world), {.law = LawName::linear_viscous, .threads = threads});
}

void add_fines(Simulation& simulation, const TieBed& bed, const TieTest& test, std::uint64_t seed,
               bool fill) {
    FoulingOptions fouling = bed.fouling;
    World& world = simulation.world();
    const auto& rocks = world.resource<RockBed>();
    const Vec3 half(0.5 * bed.width(), 0.5 * mould_length(bed), 0);
    const double top = plate_height(world);
    const Vec3 tie = value_of<Position>(world, rocks.tie), tie_half = 0.5 * rocks.tie_size;
    if (test.vci > 0) {
        const double ballast =
            world.resource<Materials>().list[rocks.rock].density * rocks.solid_volume;
        const double voids = 4 * half.x() * half.y() * top -
                             0.5 * bed.tie_width * bed.tie_length * bed.tie_height -
                             rocks.solid_volume;
        fouling.p4 = p4_of_vci(test.vci, fouling.settings, ballast, voids);
    }
    if (!fouling.any()) return;
    add_fouling(world, fouling);
    auto& fields = world.resource<Fouling>();
    fields.box = {-half, half + Vec3(0, 0, top + bed.fouling.settings.voxel)};
    fields.blocked = {{tie - tie_half, tie + tie_half}};
    simulation.prepare();
    if (fill) fill_with_fines(world, fouling, seed);
}

} // namespace bris
