#include "systems/fields/displace.hpp"
#include "systems/fields/hydraulics.hpp"
#include "systems/fields/initial_fouling.hpp"
#include "systems/fields/migration.hpp"
#include "tests/support.hpp"

#include <doctest/doctest.h>

using namespace bris;
using namespace bris::testing;

namespace {

/// An empty column of voids, n voxels of h high and one voxel wide, with a tiny rock far above.
World column(const FoulingSettings& settings, int n) {
    World world = make_world(Grains::spheres);
    const auto material = add_material(world, {"rock", 2650, 1e6});
    const double h = settings.voxel;
    add_sphere(world, Vec3(0.5 * h, 0.5 * h, (n - 0.5) * h), 1e-6 * h, material, Motion::fixed);
    add_fouling(world, settings, {}, {Vec3::Zero(), Vec3(h, h, n * h)});
    prepare_voids(world);
    auto& f = world.resource<Fouling>();
    f.fines_unit = f.water_unit = exact_unit(1e3);
    return world;
}

std::uint32_t at(const Fouling& f, int z) { return f.blocks.number({0, 0, z}); }

} // namespace

TEST_SUITE("fields/migration") {
    TEST_CASE("fines spread as the heat equation says") {
        // cosine of one half wave between closed ends decays as exp(-D k^2 t)
        const int n = 40;
        const double h = 0.01, d = 2e-5, k = pi / (n * h);
        World world = column({.voxel = h, .samples = 2, .diffusivity = d}, n);
        auto& f = world.resource<Fouling>();
        const auto profile = [&](int z) { return std::cos(k * (z + 0.5) * h); };
        for (int z = 0; z < n; ++z)
            f.fines[at(f, z)] = floor_to(f.fines_unit, 1e-4 * (1 + 0.5 * profile(z)));
        const double before = f.fines.sum(), t = 300;
        move_fines_and_water(f, t);
        CHECK(f.fines.sum() == before); // to the last bit
        for (int z = 0; z < n; ++z)
            CHECK(f.fines[at(f, z)] ==
                  doctest::Approx(1e-4 * (1 + 0.5 * std::exp(-d * k * k * t) * profile(z)))
                      .epsilon(1e-4));
    }

    TEST_CASE("pumped fines rise at the given speed and pile up below what is full") {
        const int n = 60;
        const double h = 0.01, w = 1e-3;
        World world = column({.voxel = h, .samples = 2, .pumping = w}, n);
        auto& f = world.resource<Fouling>();
        for (int z = 5; z < 15; ++z) f.fines[at(f, z)] = floor_to(f.fines_unit, 1e-4);
        const double before = f.fines.sum(), t = 100;
        const auto centre = [&] {
            double sum = 0;
            for (int z = 0; z < n; ++z) sum += (z + 0.5) * h * f.fines[at(f, z)];
            return sum / f.fines.sum();
        };
        const double from = centre();
        move_fines_and_water(f, t);
        CHECK(centre() - from == doctest::Approx(w * t).epsilon(1e-6)); // upwind is exact here
        move_fines_and_water(f, 5000);
        CHECK(f.fines.sum() == before);
        CHECK(f.fines[at(f, n - 1)] > 0.9e-3); // a tenth of the ten that there are, and more
        const double capacity = 2600 / 1.4 * h * h * h;
        CHECK(f.fines[at(f, n - 1)] <= capacity);
        CHECK(centre() > (n - 3) * h);
    }

    TEST_CASE("water drains by the kinematic wave of unit gradient") {
        // s = (z phi / (K m t))^(1 / (m - 1)) at the depth z behind the front (Sisson et al. 1980)
        const int n = 80;
        const double h = 0.01, m = 3.5;
        World world = column({.voxel = h, .samples = 2, .drains = true}, n);
        auto& f = world.resource<Fouling>();
        const double each = h * h * h;
        for (int z = 0; z < n; ++z) f.water[at(f, z)] = floor_to(f.water_unit, each);
        const double before = f.water.sum();
        const double conductivity = bris::conductivity(f.settings, 0.95, 0);
        const double t = 3 * n * h / (m * conductivity); // three times the front's way through
        move_fines_and_water(f, t);
        CHECK(f.water.sum() + f.drained == before);
        CHECK(f.drained > 0.3 * before);
        for (int z = 0; z < n - 10; ++z) {
            const double depth = (n - z - 0.5) * h;
            const double s = std::pow(depth / (conductivity * m * t), 1 / (m - 1));
            CHECK(f.water[at(f, z)] / each == doctest::Approx(s).epsilon(0.03));
        }
    }

    TEST_CASE("fines keep water that drains from clean ballast") {
        const FoulingSettings s;
        CHECK(conductivity(s, 0.42, 0) == doctest::Approx(filter_velocity(0.42, 0.03, 1)));
        CHECK(conductivity(s, 0.42, 0.5) < 0.02 * conductivity(s, 0.42, 0));
        CHECK(conductivity(s, 0.42, 1) == doctest::Approx(kozeny_carman(0.8 / 1.8, 2e-4)));
    }

    TEST_CASE(
        "the step is half of the limit of stability of the heat equation in three dimensions") {
        World world = column({.voxel = 0.01, .samples = 2, .diffusivity = 1e-5}, 10);
        const auto& f = world.resource<Fouling>();
        CHECK(migration_step(f) == doctest::Approx(0.5 * 1e-4 / (6 * 1e-5)));
    }
}
