#include "engine/errors.hpp"
#include "engine/estimation/linear_fit.hpp"
#include "scenarios/bulk/bulk_bed.hpp"
#include "scenarios/bulk/bulk_run.hpp"
#include "scenarios/specimens/lattice.hpp"
#include "scenarios/specimens/retire.hpp"
#include "scenarios/specimens/vessels.hpp"
#include "tests/about.hpp"
#include "tests/scenarios/faults/process.hpp"
#include "tests/support.hpp"

#include <doctest/doctest.h>

#include <algorithm>

using namespace bris;
using namespace bris::testing;

namespace {

constexpr unsigned spheres = 400;
constexpr double diameter = 0.006, softness = 0.01, step = 4e-5;
constexpr Silo small_silo{
    .radius = 0.04, .orifice_radius = 0.016, .lip = 0, .barrel = 0.024, .top = 0.2, .sectors = 32};
constexpr EntityId plate = 1;

Simulation filled_silo(double friction) {
    World world = make_world(Grains::spheres);
    const BulkMaterials materials = add_bulk_materials(world);
    (void)add_silo(world, small_silo, materials.steel);
    const auto inside = [](const Vec3& x) {
        const double out = std::hypot(x.x(), x.y()), clear = 0.52 * diameter;
        return x.z() > clear && out < 0.04 - clear &&
               (0.016 + x.z() - out) * std::sqrt(0.5) > clear;
    };
    for (const Vec3& site :
         lattice_sites({Vec3(-0.04, -0.04, 0), Vec3(0.04, 0.04, 0.2), 1.1 * diameter, 0.02, 3},
                       spheres, inside))
        add_sphere(world, site, diameter / 2, materials.m1);
    world.add_resource<Gravity>();
    world.add_resource<BedState>();
    Simulation simulation =
        begin(std::move(world), {.dt = step, .law = LawName::hertz_mindlin_viscous});
    const bris::BedSettings settings{.step = step,
                                     .stiffness = softness,
                                     .friction = friction,
                                     .softness = softness,
                                     .longest_pour = 0.3,
                                     .longest_rest = 0.1};
    BedMaker maker(simulation, settings);
    while (maker.advance()) {
    }
    return simulation;
}

struct Discharge {
    std::vector<double> time, above;
    bool all_there = true; // every sphere is above the lip, below it or retired, at every sample
};

Discharge discharge(double friction) {
    Simulation simulation = filled_silo(friction);
    World& world = simulation.world();
    CHECK(world.resource<BedState>().coordination > 3);
    take_away(world, plate, Vec3(0, 0, -10));
    start_clock(world, step);
    Discharge d;
    unsigned retired = 0;
    do {
        unsigned above = 0, below = 0;
        std::vector<Row> gone;
        for (Row b = 0; b < world.table<Bodies>().size(); ++b) {
            if (world.column<Bodies, MotionOf>()[b] != static_cast<std::uint32_t>(Motion::free))
                continue;
            const double z = world.column<Bodies, Position>()[b].z();
            ++(z > 0 ? above : below);
            if (z < -0.03) gone.push_back(b);
        }
        d.all_there = d.all_there && above + below + retired == spheres;
        d.time.push_back(world.resource<Clock>().time());
        d.above.push_back(above);
        retire_bodies(world, gone);
        retired += static_cast<unsigned>(gone.size());
        simulation.prepare();
        simulation.advance(250);
    } while (d.above.back() > 0 && d.time.back() < 2);
    return d;
}

double rate(const Discharge& d) {
    double from = 0, to = 0;
    for (std::size_t k = 0; k < d.time.size(); ++k) {
        if (d.above[k] > 0.9 * spheres) from = d.time[k];
        if (d.above[k] > 0.3 * spheres) to = d.time[k];
    }
    return -fit_line(d.time, d.above, from, to).slope;
}

} // namespace

TEST_SUITE("bulk/bulk") {
    TEST_CASE("a vessel that is far too wide for its spheres is refused instead of searched") {
        const SiteLattice wide{Vec3(-100, -100, 0), Vec3(100, 100, 100), 0.01, 0.02, 1};
        const auto nowhere = [](const Vec3&) { return false; };
        CHECK_THROWS_WITH_AS(lattice_sites(wide, 5, nowhere),
                             doctest::Contains("expected a vessel with at most 1e+09 places"),
                             InputError);
    }

    TEST_CASE("the grains of a wide impact bed stay within its limits") {
        const TemporaryDirectory folder;
        const Outcome wide =
            run_process({"impact_bed", "--spheres", "10", "--length", "1", "--width", "0.7",
                         "--duration", "0.001", "--quiet", "--out", (folder / "out").string()});
        CAPTURE(wide.err);
        CHECK(wide.code == 0);
    }

    TEST_CASE("a silo empties without losing a sphere, and faster without friction") {
        const Discharge rough = discharge(1), smooth = discharge(0);
        for (const Discharge& d : {rough, smooth}) {
            CHECK(d.all_there);
            CHECK(d.above.front() == spheres);
            CHECK(d.above.back() == 0);
        }
        // Beverloo's law with C = 0.58, k = 1.4 and a solid fraction of 0.6; with an orifice of 5
        // diameters, and a conical bottom on which nothing rests, codes and experiments are within
        // a third
        const double open = 0.032 - 1.4 * diameter,
                     beverloo = 0.58 * 0.6 / (pi / 6 * std::pow(diameter, 3)) * std::sqrt(9.81) *
                                std::pow(open, 2.5);
        MESSAGE("discharge rates ", rate(rough), " and ", rate(smooth), " 1/s, Beverloo ",
                beverloo);
        CHECK(rate(rough) == about(beverloo).epsilon(0.33));
        CHECK(rate(smooth) > 1.2 * rate(rough)); // a frictionless arch carries nothing
    }

    TEST_CASE("the duration of a Hertz impact agrees with Johnson's formula") {
        // by hand for R = 1 mm, rho = 2500, E = 1 GPa, 1 m/s: m* = 5.236e-6 kg,
        // E* = 0.5208e9 Pa, R* = 0.5e-3 m: 2.87 (2.742e-11 / (5e-4 * 2.7127e17 * 1))^0.2 = 3.304e-5
        // s
        CHECK(hertz_contact_time(0.001, 2500, 1e9, 1) == about(3.304e-5).epsilon(1e-3));
        CHECK(hertz_contact_time(0.001, 2500, 1e9, 32) == about(0.5 * 3.304e-5).epsilon(1e-3));
    }
}
