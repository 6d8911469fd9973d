#include "scenarios/field_tests/shear_box.hpp"

#include "components/fouling.hpp"
#include "components/kinds.hpp"
#include "components/settings.hpp"
#include "engine/errors.hpp"
#include "scenarios/field_tests/grains.hpp"
#include "scenarios/rocks/own_rocks.hpp"
#include "scenarios/specimens/rock_material.hpp"
#include "scenarios/specimens/scene.hpp"
#include "scenarios/specimens/start.hpp"
#include "systems/fields/fouling.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace bris {

namespace {

/// By how much the porosity of a whole box exceeds that of its core, for rocks of a mean size (m):
/// within half a rock of the sides there are more voids. The factor is that of specimens that were
/// made; it decides how well the height of a specimen meets the one asked for, nothing else.
double wall_excess(const ShearBox& box, double size) {
    constexpr double factor = 0.19;
    const Vec3 core = Vec3::Ones() - size * Vec3(box.length, box.width, box.height).cwiseInverse();
    return factor * (1 - core.cwiseMax(0).prod());
}

double mean_sieve(const RockSample& sample) {
    double sum = 0;
    for (const RockChoice& rock : sample.rocks) sum += rock.sieve;
    return sum / static_cast<double>(sample.rocks.size());
}

/// m3, of the voids of a specimen between floor and plate.
double voids_of(const World& world, const ShearBox& box) {
    return box.area() * plate_height(world) - world.resource<RockBed>().solid_volume;
}

constexpr std::uint32_t grains_material = 3; // after rock, end walls and sides
constexpr double rim = 0.05;                 // m, by which sides reach beyond the box

void require_different(const std::vector<double>& values, const char* option) {
    auto sorted = values;
    std::ranges::sort(sorted);
    const auto twice = std::ranges::adjacent_find(sorted);
    require(twice == sorted.end(), fmt::format("{}: expected different values, found {:g} twice",
                                               option, twice == sorted.end() ? 0.0 : *twice));
}

/// A vertical side at x, facing `inwards` (+1 or -1), from `low` to `high`.
void add_side(World& world, EntityId half, double x, double inwards, double width, double low,
              double high) {
    const double y = 0.5 * width + rim;
    FacetShape side{{Vec3(x, -y, low), Vec3(x, y, low), Vec3(x, y, high), Vec3(x, -y, high)}};
    if (inwards < 0) std::swap(side.corners[1], side.corners[3]);
    add_facet(world, half, side);
}

/// The two halves: sides along x, and flanges at the plane between them that hold the rocks beside
/// the other half once it has moved.
BoxHalves add_halves(World& world, const ShearBox& box, std::uint32_t side) {
    const double x = 0.5 * box.length, y = 0.5 * box.width + rim, plane = box.plane(),
                 flange = box.displacement + rim, top = 2 * box.height + rim;
    const double reach = 2 * (box.length + box.width + top + flange);
    BoxHalves halves;
    halves.lower = add_boundary(world, Vec3::Zero(), side, Motion::fixed, reach);
    halves.upper = add_boundary(world, Vec3::Zero(), side, Motion::fixed, reach);
    add_side(world, halves.lower, -x, 1, box.width, -rim, plane);
    add_side(world, halves.lower, x, -1, box.width, -rim, plane);
    add_side(world, halves.upper, -x, 1, box.width, plane, top);
    add_side(world, halves.upper, x, -1, box.width, plane, top);
    add_facet(world, halves.lower,
              {{Vec3(-x - flange, -y, plane), Vec3(-x, -y, plane), Vec3(-x, y, plane),
                Vec3(-x - flange, y, plane)}});
    add_facet(world, halves.upper,
              {{Vec3(x, -y, plane), Vec3(x, y, plane), Vec3(x + flange, y, plane),
                Vec3(x + flange, -y, plane)}});
    return halves;
}

} // namespace

void check_shear_box(const ShearBox& box) {
    check_fouling(box.fouling);
    require_different(box.normal_stress, "--normal-stress");
    require_different(box.vci, "--vci");
    require(!box.normal_stress.empty(), "--normal-stress: expected at least one, found none");
    require(!box.vci.empty(), "--vci: expected at least one, found none");
    require(std::ranges::max(box.vci) == 0 || !box.fouling.any(),
            "--vci: expected no --fouling-p4, --fouling-file and --saturation with values above "
            "0, found them");
    require(box.fines != "grains" || !box.fouling.any(),
            "--fines: expected no --fouling-p4, --fouling-file and --saturation with grains, whose "
            "amount is that of --vci, found them");
    require(
        box.displacement <= box.length / 3,
        fmt::format("--displacement: expected at most a third of --length, {:g} m, found {:g} m",
                    box.length / 3, box.displacement));
    require(box.interval <= box.displacement / 10,
            fmt::format("--interval: expected at most a tenth of --displacement, {:g} m, found "
                        "{:g} m",
                        box.displacement / 10, box.interval));
    const double least = plate_mass * 9.81 / box.area();
    const double found = std::ranges::min(box.normal_stress);
    require(found > 2 * least,
            fmt::format("--normal-stress: expected more than twice the weight of the plate, {:.3g} "
                        "Pa, found {:g} Pa",
                        2 * least, found));
    require(box.preparation_pressure > 2 * least,
            fmt::format("--preparation-pressure: expected more than twice the weight of the plate, "
                        "{:.3g} Pa, found {:g} Pa",
                        2 * least, box.preparation_pressure));
}

Simulation make_shear_box(const ShearBox& box, std::uint64_t seed, unsigned threads) {
    check_shear_box(box);
    const std::vector<Clump> clumps = rocks_among(clumps_of(box.rocks.clumps));
    const double volume = box.area() * box.height;
    const double size = mean_sieve(sample_of_volume(box.rocks, clumps, 0.5 * volume, seed));
    const double porosity = std::min(box.porosity + wall_excess(box, size), 0.9);
    const RockSample sample = sample_of_volume(box.rocks, clumps, (1 - porosity) * volume, seed);
    const double largest = std::ranges::max(sample.rocks, {}, &RockChoice::sieve).sieve,
                 side = std::min(box.length, box.width);
    require(side >= box.least_box * largest,
            fmt::format("--length, --width: expected at least {:g} times the largest rock of "
                        "{:.1f} mm (--least-box, --rock-scale), found {:.1f} mm",
                        box.least_box, 1e3 * largest, 1e3 * side));
    return make_shear_box(box, clumps, sample, seed, threads);
}

Simulation make_shear_box(const ShearBox& box, const std::vector<Clump>& clumps,
                          const RockSample& sample, std::uint64_t seed, unsigned threads) {
    World world = make_world(Grains::clumps);
    auto& materials = world.resource<Materials>();
    const Material rock = read_rock_material(box.material).material("rock");
    const auto rough = materials.add(rock);
    Material steel = rock;
    steel.name = "end wall";
    steel.friction = box.wall_friction;
    const auto end = materials.add(steel);
    steel.name = "side";
    steel.friction = 0; // sides that are rough would carry shear past the plane between the halves
    const auto smooth = materials.add(steel);
    Material grain = rock;
    grain.name = "fines";
    grain.density = of_kind(box.fouling).settings.density;
    grain.friction = box.fines_friction;
    materials.add(grain);
    add_rock_bed(world,
                 {.size = Vec3(box.length, box.width, box.height),
                  .porosity = box.porosity,
                  .tolerance = box.porosity_tolerance,
                  .pressure = box.preparation_pressure,
                  .seed = seed},
                 clumps, sample, rough, rim);
    BoxHalves halves = add_halves(world, box, end);
    const EntityId sides = add_boundary(world, Vec3::Zero(), smooth);
    add_plane(world, sides, Vec3(0, -0.5 * box.width, 0), Vec3::UnitY());
    add_plane(world, sides, Vec3(0, 0.5 * box.width, 0), -Vec3::UnitY());
    halves.floor = add_boundary(world, Vec3::Zero(), rough);
    add_plane(world, halves.floor, Vec3::Zero(), Vec3::UnitZ());
    world.resource<RockBed>().first_grain = static_cast<EntityId>(world.table<Bodies>().size());
    world.add_resource(halves);
    world.add_resource(ShearState{});
    return start(std::move(world),
                 {.law = LawName::linear_viscous, .threads = threads, .energy_budget = true});
}

void add_fines(Simulation& simulation, const ShearBox& box, const ShearTest& test,
               std::uint64_t seed, bool fill) {
    FoulingOptions fouling = of_kind(box.fouling);
    World& world = simulation.world();
    const double voids = voids_of(world, box);
    const Vec3 half(0.5 * box.length, 0.5 * box.width, 0),
        high = half + Vec3(0, 0, plate_height(world));
    if (box.fines == "grains" && test.vci > 0) {
        if (fill)
            add_grains(world,
                       {.size = box.fines_size,
                        .material = grains_material,
                        .solid_volume = 0.01 * test.vci * voids / (1 + fouling.settings.void_ratio),
                        .low = -half,
                        .high = high},
                       seed);
        return;
    }
    if (test.vci > 0) {
        const auto& bed = world.resource<RockBed>();
        const double density = world.resource<Materials>().list[bed.rock].density;
        fouling.p4 = p4_of_vci(test.vci, fouling.settings, density * bed.solid_volume, voids);
    }
    if (!fouling.any()) return;
    add_fouling(world, fouling);
    world.resource<Fouling>().box = {-half, high};
    simulation.prepare();
    if (fill) fill_with_fines(world, fouling, seed);
}

double contaminant_index(const World& world, const ShearBox& box) {
    if (world.has_resource<Fouling>())
        return measure_fouling(world, present_fouling(world)).contaminant_index;
    const auto count = static_cast<double>(grains_in(world));
    return 100 * count * pi / 6 * std::pow(box.fines_size, 3) *
           (1 + of_kind(box.fouling).settings.void_ratio) / voids_of(world, box);
}

} // namespace bris
