// Direct shear: a block whose friction is known, and a small packing.
#include "components/fouling.hpp"
#include "components/kinds.hpp"
#include "components/settings.hpp"
#include "engine/run.hpp"
#include "scenarios/field_tests/shear_box.hpp"
#include "scenarios/field_tests/shear_results.hpp"
#include "scenarios/specimens/scene.hpp"
#include "scenarios/specimens/small_scene.hpp"
#include "systems/broadphase/lists.hpp"
#include "systems/fields/fouling.hpp"
#include "tests/about.hpp"
#include "tests/quiet_run.hpp"
#include "tests/support.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <memory>

using namespace bris;
using namespace bris::testing;

namespace {

/// A test of a box that is made already.
struct ShearedBox {
    ShearedBox(const ShearBox& settings, const ShearTest& of, auto&& make,
               const std::filesystem::path& out)
        : box(settings), test(of), simulation(make()),
          common(bris::testing::quiet_run("direct_shear", out)),
          run(simulation, common, "direct_shear"), curve("shear") {
        run.keep(curve);
    }
    const World& world() const { return simulation.world(); }
    void go(const char* checkpoint_on_the_way = nullptr) {
        run.go(shear_phases(box, test, curve, [&, this, frames = 0](const World&) mutable {
            if (checkpoint_on_the_way != nullptr && ++frames == 4)
                run.save_as(checkpoint_on_the_way);
        }));
    }
    std::uint64_t fingerprint() const { return bris::fingerprint(simulation.snapshot()); }

    ShearBox box;
    ShearTest test;
    Simulation simulation;
    Common common;
    Run run;
    SeriesOf<ShearSample> curve;
};

/// A block on eight balls that stands on the floor and is held by the end wall of the upper half.
Clump block() {
    constexpr double radius = 0.01;
    Clump clump;
    clump.name = "block";
    clump.volume = 8 * 4.19e-6;
    clump.inertia = Vec3(1, 1, 1) * 2e-7;
    clump.bounding_radius = 0.11;
    clump.sieve = 0.1;
    for (const double x : {-1.0, 1.0})
        for (const double y : {-1.0, 1.0}) {
            clump.balls.push_back({Vec3(0.05 * x, 0.04 * y, -0.04), radius});
            clump.balls.push_back({Vec3(0.06 * x, 0.04 * y, 0.04), radius});
        }
    return clump;
}

ShearBox small_box() {
    ShearBox box;
    box.length = box.width = 0.16;
    box.height = 0.14;
    box.least_box = 3;
    box.rocks.smallest = 0.03;
    box.porosity = 0.43;
    box.displacement = 0.004;
    box.speed = 0.05;
    box.fouling.settings.voxel = 0.01;
    return box;
}

} // namespace

TEST_SUITE("direct_shear") {
    TEST_CASE("the shear stress of a block that slides on the floor is friction times normal "
              "stress, and the work put in is the work of friction") {
        const TemporaryDirectory folder;
        ShearBox box;
        box.length = 0.3;
        box.width = 0.2;
        box.height = 0.09; // the centre of the block lies above the middle of the box
        box.displacement = 0.01;
        box.speed = 0.02;
        const RockSample sample{.rocks = {{0, 0.1}}};
        constexpr double friction = 0.3;
        ShearedBox sheared(
            box, {.normal_stress = 50e3},
            [&] { return make_shear_box(box, {block()}, sample, 1, 1); }, folder.path());
        World& world = sheared.simulation.world();
        auto& materials = world.resource<Materials>();
        const auto& bed = world.resource<RockBed>();
        materials.list[bed.rock].friction = friction;
        materials.mix();
        const EntityId id = bed.rocks.front();
        value_of<Position>(world, id) = Vec3(0.15 - 0.07, 0, 0.05);
        value_of<Orientation>(world, id).setIdentity();
        value_of<Position>(world, bed.plate).z() = 0.1 + 0.5 * plate_thickness;
        for (const EntityId body : {id, bed.plate})
            value_of<MotionOf>(world, body) = static_cast<std::uint32_t>(Motion::free);
        invalidate_lists(world);
        rescale_masses(world, box.safety);
        sheared.go();

        const auto &shear = sheared.curve[&ShearSample::shear_force_lower_half],
                   &upper = sheared.curve[&ShearSample::shear_force_upper_half],
                   &normal = sheared.curve[&ShearSample::normal_force_lower_half],
                   &ratio = sheared.curve[&ShearSample::stress_ratio];
        REQUIRE(shear.size() == 101);
        // the spring of the contact has slipped by then
        for (std::size_t k = 10; k < shear.size(); ++k) {
            CHECK(shear[k] == about(friction * normal[k]).epsilon(1e-6));
            CHECK(upper[k] == about(shear[k]).epsilon(1e-3));
            CHECK(ratio[k] == about(friction).epsilon(1e-3));
        }
        const ShearProperties p = properties_of(sheared.curve);
        CHECK(p.peak_angle() == about(std::atan(friction) * 180 / pi).epsilon(2e-3));
        CHECK(p.residual_normal == about(50e3).epsilon(2e-3));
        CHECK(std::abs(p.dilation) < 1e-5);
        CHECK(p.energy_error < 1e-3);
        const double lost = sheared.curve[&ShearSample::work_lost].back() -
                            sheared.curve[&ShearSample::work_lost].front();
        CHECK(lost == about(friction * 50e3 * box.area() * box.displacement).epsilon(0.01));
    }

    TEST_CASE("a small packing has its porosity, both halves carry the same shear force, energy is "
              "closed, and the bits are the same for any threads and after resuming") {
        const TemporaryDirectory folder;
        const ShearBox box = small_box();
        const auto fresh = [&](unsigned threads) {
            return [&box, threads] { return make_shear_box(box, 1, threads); };
        };
        Simulation bed = fresh(1)();
        Run making(bed, bris::testing::quiet_run("direct_shear", folder.path()), "specimen");
        making.go(make_bed_phases());
        const Archive made = bed.snapshot();
        CHECK(std::as_const(bed).world().resource<RockBedState>().porosity ==
              about(box.porosity).epsilon(box.porosity_tolerance / box.porosity));

        ShearedBox clean(box, {.normal_stress = 50e3}, fresh(1), folder.path());
        clean.simulation.restore(made);
        clean.go();
        const ShearProperties p = properties_of(clean.curve);
        CHECK(p.shear_imbalance < 0.03);
        CHECK(p.normal_imbalance < 0.03);
        CHECK(p.energy_error < 2e-3);
        CHECK(p.inertial_number < 3e-3);
        CHECK(p.residual_normal == about(50e3).epsilon(0.05)); // with the weight of some rocks
        CHECK(p.peak_ratio() > 0.7); // the packing is stronger than its contacts
        const auto& lost = clean.curve[&ShearSample::work_lost];
        CHECK(std::ranges::is_sorted(lost));

        const auto fouled = [&](unsigned threads) {
            auto run = std::make_unique<ShearedBox>(
                box, ShearTest{.normal_stress = 50e3, .vci = 40}, fresh(threads), folder.path());
            run->simulation.restore(made);
            add_fines(run->simulation, box, run->test, 1, true);
            return run;
        };
        const auto fouled_by_one = fouled(1);
        ShearedBox& one = *fouled_by_one;
        const double fines = measure_fouling(one.world(), present_fouling(one.world())).fines_mass;
        one.go("middle");
        const FoulingMeasures m = measure_fouling(one.world(), present_fouling(one.world()));
        CHECK(m.fines_mass == about(fines).epsilon(1e-12));
        CHECK(one.world().resource<ShearState>().start_vci == about(40).epsilon(0.03));
        CHECK(one.fingerprint() != clean.fingerprint());
        for (const unsigned threads : {2U, 3U}) {
            const auto other = fouled(threads);
            other->go();
            CHECK(other->fingerprint() == one.fingerprint());
        }
        ShearedBox resumed(box, one.test, fresh(1), folder.path());
        add_fines(resumed.simulation, box, resumed.test, 1, false);
        resumed.run.resume(folder / "middle.ckpt.h5");
        CHECK(resumed.curve.rows() < one.curve.rows());
        resumed.go();
        CHECK(resumed.fingerprint() == one.fingerprint());
        CHECK(resumed.curve[&ShearSample::shear_stress] == one.curve[&ShearSample::shear_stress]);

        // fines as grains, which carry forces and have weight
        ShearBox with_grains = box;
        with_grains.fines = "grains";
        const auto grained = [&](unsigned threads) {
            return std::make_unique<ShearedBox>(with_grains,
                                                ShearTest{.normal_stress = 50e3, .vci = 20},
                                                fresh(threads), folder.path());
        };
        const auto grains = grained(1);
        grains->simulation.restore(made);
        add_fines(grains->simulation, with_grains, grains->test, 2, true);
        grains->go("grains");
        CHECK_FALSE(grains->world().has_resource<Fouling>());
        CHECK(grains->world().resource<ShearState>().start_vci == about(20).epsilon(0.05));
        const auto number =
            grains->world().table<Bodies>().size() - clean.world().table<Bodies>().size();
        const auto &weight = grains->curve[&ShearSample::weight_of_rocks],
                   &without = clean.curve[&ShearSample::weight_of_rocks];
        CHECK(weight[0] - without[0] == about(9.81 * with_grains.fouling.settings.density *
                                              static_cast<double>(number) * pi / 6 * 1e-6));
        const ShearProperties g = properties_of(grains->curve);
        CHECK(g.shear_imbalance < 0.03);
        CHECK(g.normal_imbalance < 0.03);
        CHECK(g.energy_error < 2e-3);
        const auto by_two = grained(2);
        by_two->simulation.restore(made);
        add_fines(by_two->simulation, with_grains, by_two->test, 2, true);
        by_two->go();
        CHECK(by_two->fingerprint() == grains->fingerprint());
        const auto continued = grained(1);
        add_fines(continued->simulation, with_grains, continued->test, 2, false);
        continued->run.resume(folder / "grains.ckpt.h5");
        continued->go();
        CHECK(continued->fingerprint() == grains->fingerprint());
    }

    TEST_CASE("peak, residual stress and dilation angle of a known curve are found") {
        SeriesOf<ShearSample> curve("shear");
        for (int k = 0; k <= 300; ++k) {
            const double x = 1e-4 * k, force = k < 100 ? k : (k < 110 ? 100 : 60);
            const double dilation = 0.5 * std::clamp(x - 0.01, 0.0, 0.01);
            curve.add({x, 600 * force, 50e3, force / 80, 60e3, dilation, force, force, 1000, 990,
                       10, 1 + 2 * x, x, x, 0, 0, 0, 1e-3});
        }
        const ShearProperties p = properties_of(curve);
        CHECK(p.peak_stress == about(60e3).epsilon(1e-9));
        CHECK(p.peak_displacement == about(0.0109).epsilon(0.01));
        CHECK(p.peak_angle() == about(std::atan(1.2) * 180 / pi));
        CHECK(p.peak_plane_angle() == about(45).epsilon(1e-9));
        CHECK(p.residual_stress == about(36e3));
        CHECK(p.dilation == about(0.005));
        CHECK(p.dilation_angle == about(std::atan(0.5) * 180 / pi).epsilon(1e-6));
        CHECK(p.shear_imbalance == 0);
        CHECK(p.normal_imbalance < 1e-12);
        CHECK(p.energy_error < 1e-12);
    }

    TEST_CASE("fits recover cohesion, friction angle and the exponent of a power law") {
        const std::vector<double> normal{15e3, 30e3, 60e3};
        std::vector<double> line, power;
        for (const double s : normal) {
            line.push_back(5e3 + s * std::tan(40 * pi / 180));
            power.push_back(8 * std::pow(s, 0.8));
        }
        CHECK(fit_strength(normal, line).cohesion == about(5e3).epsilon(1e-9));
        CHECK(fit_strength(normal, line).angle == about(40).epsilon(1e-9));
        CHECK(fit_strength(normal, power).exponent == about(0.8).epsilon(1e-9));
        CHECK(fit_strength(normal, power).factor == about(8).epsilon(1e-9));
    }

    TEST_CASE("settings that do not fit together are refused by name") {
        const auto refused = [](auto&& change) {
            ShearBox box = small_box();
            change(box);
            return refusal_of([&] { check_shear_box(box); });
        };
        CHECK(refused([](ShearBox&) {}).empty());
        CHECK(refused([](ShearBox& b) { b.displacement = 0.1; }).find("--displacement") == 0);
        CHECK(refused([](ShearBox& b) { b.interval = 0.001; }).find("--interval") == 0);
        CHECK(refused([](ShearBox& b) { b.vci = {0, 0}; }).find("--vci") == 0);
        CHECK(refused([](ShearBox& b) { b.normal_stress = {1e3}; }).find("--normal-stress") == 0);
        CHECK(refused([](ShearBox& b) {
                  b.vci = {0, 20};
                  b.fouling.p4 = 5;
              }).find("--vci") == 0);
        ShearBox packed = small_box();
        packed.fines = "grains";
        packed.fines_size = 1e-3;
        Simulation simulation = make_shear_box(packed, 1, 1);
        CHECK(refusal_of([&] {
                  add_fines(simulation, packed, {.vci = 140}, 1, true);
              }).find("--fines-size") == 0);
        ShearBox narrow = small_box();
        narrow.least_box = 6;
        CHECK(refusal_of([&] { (void)make_shear_box(narrow, 1, 1); }).find("--least-box") !=
              std::string::npos);
    }
}
