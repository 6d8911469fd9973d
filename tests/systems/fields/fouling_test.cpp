#include "engine/ordering.hpp"
#include "engine/parallel.hpp"
#include "engine/state.hpp"
#include "scenarios/specimens/start.hpp"
#include "systems/contact/stable_step.hpp"
#include "systems/fields/displace.hpp"
#include "systems/fields/fouling.hpp"
#include "systems/fields/initial_fouling.hpp"
#include "systems/fields/weaken_contacts.hpp"
#include "tests/support.hpp"

#include <doctest/doctest.h>

using namespace bris;
using namespace bris::testing;

namespace {

constexpr FoulingSettings small{.voxel = 5e-3, .samples = 2, .refresh = 0.05, .check_every = 20};

World fouled_bed(const InitialFouling& initial, Grains grains = Grains::clumps,
                 const FoulingLaw& law = {}) {
    World world = bed({.grains = grains, .bodies = 40, .seed = 4});
    add_fouling(world, small, law);
    fill_with_fines(world, initial);
    return world;
}

Simulation started(World world, unsigned threads = 1, ListSettings lists = {}) {
    return begin(std::move(world),
                 {.dt = 2e-5, .law = LawName::linear_viscous, .threads = threads, .lists = lists});
}

/// The State without that of fines and water.
Archive mechanics(const Archive& state) {
    Archive some;
    for (const Archive::Array& array : state.arrays())
        if (!array.path.starts_with("fields/") && array.path != "bodies/fouling" &&
            array.path != "bodies/sampled_pose")
            some.put(Archive::Array(array));
    return some;
}

std::uint64_t print_of(const Simulation& s) { return fingerprint(s.snapshot()); }

} // namespace

TEST_SUITE("fields/fouling") {
    TEST_CASE("fines are the share of the mass that P4 asks for, and FI, VCI and PVC follow") {
        World world = fouled_bed({.p4 = 17, .p200 = 3.05, .saturation = 0.5});
        const Fouling present = present_fouling(world);
        const FoulingMeasures m = measure_fouling(world, present);
        double ballast = 0;
        for (const double mass : world.column<Bodies, Mass>()) ballast += mass;
        CHECK(m.ballast_mass == doctest::Approx(ballast));
        CHECK(m.fines_mass == doctest::Approx(ballast * 17 / 83).epsilon(1e-12));
        CHECK(m.p4 == doctest::Approx(17));
        CHECK(m.fouling_index == doctest::Approx(20.05)); // that of the SmartRock report
        CHECK(fouling_class(m.fouling_index) == "fouled");
        // VCI = (1 + e_f) / e_b * rho_b / rho_f * M_f / M_b with e_b = V_v / V_s
        const double solids = ballast / world.resource<Materials>().list[0].density;
        CHECK(m.contaminant_index ==
              doctest::Approx(100 * 1.8 * solids / m.void_volume *
                              (ballast / solids / present.settings.density) * 17 / 83));
        CHECK(m.void_contamination == doctest::Approx(m.contaminant_index * 1.4 / 1.8));
        CHECK(m.saturation == doctest::Approx(50).epsilon(1e-6));
    }

    TEST_CASE("the classes of Selig and Waters begin at 1, 10, 20 and 40") {
        CHECK(fouling_class(0.99) == "clean");
        CHECK(fouling_class(1) == "moderately clean");
        CHECK(fouling_class(9.99) == "moderately clean");
        CHECK(fouling_class(10) == "moderately fouled");
        CHECK(fouling_class(20) == "fouled");
        CHECK(fouling_class(25.48) == "fouled"); // 18.48 + 7
        CHECK(fouling_class(40) == "highly fouled");
    }

    TEST_CASE("the void contaminant index of a box is that of the published example") {
        // (1 + e_f) / e_b * G_b / G_f * M_f / M_b for e_b = 0.74, e_f = 0.7, 2.65, 2.6, 0.1
        FoulingMeasures m{.ballast_mass = 2650, .fines_mass = 265, .void_volume = 0.74};
        complete(m, {.density = 2600, .void_ratio = 0.7});
        CHECK(m.contaminant_index == doctest::Approx(23.415).epsilon(1e-4));
        CHECK(m.p4 == doctest::Approx(100 * 265.0 / 2915));
    }

    TEST_CASE("layers and random fines hold the same mass where they are asked for") {
        for (const auto pattern :
             {InitialFouling::Pattern::layered, InitialFouling::Pattern::random}) {
            World world = fouled_bed(
                {.pattern = pattern, .p4 = 5, .p200 = 1, .low = 0.1, .high = 0.6, .seed = 9});
            const auto& f = world.resource<Fouling>();
            double ballast = 0;
            for (const double mass : world.column<Bodies, Mass>()) ballast += mass;
            CHECK(f.fines.sum() == doctest::Approx(ballast * 5 / 95).epsilon(1e-12));
            const BodySpheres bodies = spheres_of_bodies(world);
            double low = 1e9, high = -1e9;
            for (std::size_t b = 0; b < bodies.bodies(); ++b)
                if (bodies.has_spheres(b)) {
                    low = std::min(low, bodies.box[b].low.z());
                    high = std::max(high, bodies.box[b].high.z());
                }
            if (pattern == InitialFouling::Pattern::random) continue;
            const double from = low + 0.1 * (high - low), to = low + 0.6 * (high - low);
            const FoulingMeasures outside_low = measure_fouling(world, f, -1, from - small.voxel),
                                  outside_high = measure_fouling(world, f, to + small.voxel, 1);
            CHECK(outside_low.fines_mass == 0);
            CHECK(outside_high.fines_mass == 0);
        }
    }

    TEST_CASE("rocks that move 1e5 times displace fines and water and lose none") {
        World world = fouled_bed({.p4 = 12, .p200 = 2, .saturation = 0.7}, Grains::spheres);
        auto& f = world.resource<Fouling>();
        update_fouling(world, f);
        const double fines = f.fines.sum(), water = f.water.sum();
        const auto x = world.column<Bodies, Position>();
        const auto mass = world.column<Bodies, Mass>();
        const Vec3 inside_low = f.region.low + Vec3::Constant(0.01),
                   inside_high = f.region.high - Vec3::Constant(0.01);
        std::uint64_t moves = 0;
        double shifted = 0;
        for (std::uint64_t round = 0; moves < 100000; ++round) {
            // 50 moves of each rock are felt at once: fields follow displacements, not steps
            for (unsigned k = 0; k < 50; ++k)
                for (Row r = 0; r < x.size(); ++r)
                    if (mass[r] > 0) {
                        const Vec3 step = 4e-4 * Random(round * 50 + k, r).direction();
                        x[r] = (x[r] + step).cwiseMax(inside_low).cwiseMin(inside_high);
                        ++moves;
                    }
            const VoxelField before = f.fines;
            const VoxelBlocks blocks = f.blocks;
            update_fouling(world, f);
            const VoxelField then = on_blocks(before, blocks, f.blocks);
            for (std::uint32_t n = 0; n < f.blocks.voxels(); ++n)
                shifted += 0.5 * std::abs(f.fines[n] - then[n]);
            REQUIRE(f.fines.sum() == fines); // to the last bit
            REQUIRE(f.water.sum() == water);
        }
        CHECK(shifted > fines); // the moves did displace them
    }

    TEST_CASE("no voxel holds more than its voids, and there are no fines within rocks") {
        World world = fouled_bed({.p4 = 15, .p200 = 2, .saturation = 1});
        auto& f = world.resource<Fouling>();
        for (Vec3& x : world.column<Bodies, Position>()) x += Vec3(2e-3, -1e-3, 1e-3);
        update_fouling(world, f);
        CHECK(f.fines_beyond == 0);
        const double volume = f.blocks.lattice().volume();
        for (std::uint32_t n = 0; n < f.blocks.voxels(); ++n) {
            const double voids = volume * f.solid.voids()[n];
            REQUIRE(f.fines[n] * 1.4 / 2600 <= voids);
            REQUIRE(f.fines[n] >= 0);
            if (f.water_beyond == 0) REQUIRE(f.water[n] <= voids - f.fines[n] / 2600 + 1e-18);
        }
    }

    TEST_CASE("contacts have the friction and stiffness of the law, exactly and without levels") {
        const FoulingLaw law{.friction_loss = 0.3, .stiffness_loss = 0.6};
        Simulation s =
            started(fouled_bed({.p4 = 15, .p200 = 2, .saturation = 0.8}, Grains::clumps, law));
        s.advance(5000);
        const World& world = std::as_const(s).world();
        const auto& materials = world.resource<Materials>();
        const auto around = world.column<Bodies, FoulingAround>();
        const RowIndex row_of(world.column<Bodies, BodyId>());
        const auto pairs = touching_pairs<SpherePairs>(world);
        REQUIRE(pairs.size() > 20);
        const LawRow& clean = materials.linear_pairs[0];
        for (const TouchingPair& p : pairs) {
            const LocalFouling &a = around[row_of[p.names.owner]],
                               &b = around[row_of[p.names.partner]];
            const double vci = 0.5 * (a.contaminant + b.contaminant),
                         wet = 0.5 * (a.saturation + b.saturation), g = vci / (vci + 0.5);
            const LawRow& row = materials.linear_pairs[p.law];
            CHECK(row.friction ==
                  doctest::Approx(std::max(clean.friction * (1 - 0.3 * g) * (1 - 0.3 * g * wet),
                                           std::min(0.3, clean.friction))));
            CHECK(row.kn == doctest::Approx(clean.kn * std::max(1 - 0.6 * g, 1.0 / 3)));
            CHECK(row.ks / row.kn == doctest::Approx(clean.ks / clean.kn));
            CHECK(row.kn < 0.97 * clean.kn);
        }
    }

    TEST_CASE("fixed fines act on the contacts of each body wherever it goes, without fields") {
        World world = fouled_bed({.p4 = 15, .p200 = 2, .saturation = 0.8});
        update_fouling(world, world.resource<Fouling>());
        fix_fouling(world);
        std::vector<double> before;
        for (const LocalFouling& at : world.column<Bodies, FoulingAround>())
            before.push_back(at.contaminant);
        const auto id = world.column<Bodies, BodyId>();
        std::vector<double> by_id(id.size());
        for (Row b = 0; b < id.size(); ++b) by_id[id[b]] = before[b];
        for (Vec3& x : world.column<Bodies, Position>()) x += Vec3(2e-3, -1e-3, 1e-3);
        Simulation s = started(std::move(world));
        s.advance(200);
        const World& now = std::as_const(s).world();
        const auto around = now.column<Bodies, FoulingAround>();
        const auto id_now = now.column<Bodies, BodyId>();
        for (Row b = 0; b < around.size(); ++b) CHECK(around[b].contaminant == by_id[id_now[b]]);
        CHECK(now.resource<Fouling>().updates == 1);
        CHECK_FALSE(now.resource<Materials>().weakened().empty());
        CHECK_FALSE(has_fouling_fields(now));
        CHECK_THROWS_AS(present_fouling(now), InputError);

        const Archive state = s.snapshot();
        Simulation again = started(fouled_bed({.p4 = 15, .p200 = 2, .saturation = 0.8}));
        again.restore(state);
        again.advance(100);
        s.advance(100);
        CHECK(print_of(again) == print_of(s));

        World moving = bed({.grains = Grains::clumps, .bodies = 40, .seed = 4});
        FoulingSettings pumped = small;
        pumped.pumping = 1e-3;
        add_fouling(moving, pumped);
        CHECK_THROWS_AS(fix_fouling(moving), InputError);
    }

    TEST_CASE("a film of fines is in series with the contact, and water softens it") {
        const FoulingLaw law{.stiffness_loss = 0, .dry_cushion = 2, .wet_cushion = 8};
        const auto factor = [&](double vci, double wet) {
            return law.stiffness_factor({vci, wet});
        };
        CHECK(factor(0, 1) == 1);
        CHECK(factor(0.5, 0) == doctest::Approx(1 / (1 + 0.5 * 2.0)));
        CHECK(factor(0.5, 1) == doctest::Approx(1 / (1 + 0.5 * 8.0)));
        CHECK(factor(0.5, 0.5) == doctest::Approx(1 / (1 + 0.5 * 5.0)));
        // very soft fines: the contact has the stiffness of the film
        CHECK(FoulingLaw{.stiffness_loss = 0, .dry_cushion = 1e6}.stiffness_factor({1e6, 0}) ==
              doctest::Approx(1e-6).epsilon(1e-5));
        CHECK(FoulingLaw{}.stiffness_factor({0.5, 1}) == 0.75);
    }

    TEST_CASE("friction and stiffness keep their lower limits, and friction without fines below") {
        Materials materials;
        materials.add({"rock", 2650, 1e6, 1e6, 0.7});
        materials.weaken({{0, 0.2, 0.3, 1.0 / 3}});
        CHECK(materials.linear_pairs.size() == 2);
        CHECK(materials.linear_pairs[1].friction == 0.3);
        CHECK(materials.linear_pairs[1].kn == doctest::Approx(5e5 / 3));
        materials.list[0].friction = 0.1; // as while a specimen is made
        materials.mix();
        CHECK(materials.linear_pairs[1].friction == 0.1);
        materials.list[0].friction = 0.7;
        materials.weaken({});
        materials.mix();
        CHECK(materials.linear_pairs.size() == 1);
        CHECK(materials.linear_pairs[0].friction == 0.7);
    }

    TEST_CASE("without fines the mechanics has the bits of a scene without fields") {
        Simulation without = started(bed({.grains = Grains::clumps, .bodies = 40, .seed = 4}));
        Simulation dry = started(fouled_bed({})), wet = started(fouled_bed({.saturation = 0.9}));
        for (Simulation* s : {&without, &dry, &wet}) s->advance(400);
        const auto expected = fingerprint(without.snapshot());
        CHECK(fingerprint(mechanics(dry.snapshot())) == expected);
        CHECK(fingerprint(mechanics(wet.snapshot())) == expected); // clean wet = clean dry
        CHECK(wet.world().resource<Fouling>().water.sum() > 0);
        CHECK(dry.world().resource<Materials>().weakened().empty());
        // and fines do change it
        Simulation fouled = started(fouled_bed({.p4 = 10, .p200 = 1}));
        fouled.advance(400);
        CHECK(fingerprint(mechanics(fouled.snapshot())) != expected);
    }

    TEST_CASE("moisture acts where there are fines") {
        Simulation dry = started(fouled_bed({.p4 = 10, .p200 = 1})),
                   wet = started(fouled_bed({.p4 = 10, .p200 = 1, .saturation = 0.9}));
        for (Simulation* s : {&dry, &wet}) s->advance(400);
        CHECK(fingerprint(mechanics(dry.snapshot())) != fingerprint(mechanics(wet.snapshot())));
    }

    TEST_CASE("a fouled bed has the same bits for any number of threads, skin and order of rows") {
        const InitialFouling initial{.p4 = 10, .p200 = 2, .saturation = 0.5};
        std::vector<Simulation> runs;
        runs.push_back(started(fouled_bed(initial)));
        runs.push_back(started(fouled_bed(initial), 2));
        runs.push_back(started(fouled_bed(initial), 3, {.outer_skin = 4e-3, .inner_skin = 1e-3}));
        runs.push_back(started(fouled_bed(initial), 1, {.sort_every = 1}));
        for (Simulation& s : runs) s.advance(700);
        CHECK(runs[0].world().resource<Fouling>().updates > 3);
        for (Simulation& s : runs) CHECK(print_of(s) == print_of(runs[0]));
    }

    TEST_CASE("a fouled bed is resumed to the same bits between two updates of its fields") {
        const InitialFouling initial{.p4 = 10, .p200 = 2, .saturation = 0.5};
        Simulation whole = started(fouled_bed(initial)), first = started(fouled_bed(initial)),
                   second = started(fouled_bed({}));
        whole.advance(333);
        first.advance(333);
        const Archive state = first.snapshot();
        second.on_restore(forget_lists);
        second.restore(state);
        CHECK(print_of(second) == fingerprint(state));
        whole.advance(400);
        second.advance(400);
        CHECK(print_of(second) == print_of(whole));
    }

    TEST_CASE("readers do not change a run") {
        const InitialFouling initial{.p4 = 10, .p200 = 2};
        Simulation watched = started(fouled_bed(initial)), other = started(fouled_bed(initial));
        for (unsigned k = 0; k < 10; ++k) {
            watched.advance(30);
            const Fouling present = present_fouling(std::as_const(watched).world());
            CHECK(measure_fouling(watched.world(), present).p4 == doctest::Approx(10));
        }
        other.advance(300);
        CHECK(print_of(watched) == print_of(other));
    }

    TEST_CASE("the stable step is that of the weakened contacts, which are softer") {
        Simulation clean = started(fouled_bed({}));
        clean.advance(2000);
        Simulation fouled = started(fouled_bed({}));
        fouled.on_restore(forget_lists);
        fouled.restore(clean.snapshot());
        auto& f = fouled.world().resource<Fouling>();
        fill_with_fines(fouled.world(), {.p4 = 10, .p200 = 1});
        CHECK(f.stale);
        fouled.advance(1);
        clean.advance(1);
        CHECK(stable_step(fouled.world()) > 1.02 * stable_step(clean.world()));
        // before anything touches, the clean contact counts, which is the stiffest
        CHECK(stable_step_of_first_contact(fouled.world()) ==
              doctest::Approx(stable_step_of_first_contact(clean.world())).epsilon(1e-6));
    }

    TEST_CASE("bad input is refused in one line, and nothing is filled") {
        const auto refusal = [](const InitialFouling& initial) {
            World world = bed({.grains = Grains::clumps, .bodies = 40, .seed = 4});
            add_fouling(world, small);
            const std::string text = refusal_of([&] { fill_with_fines(world, initial); });
            CHECK(world.resource<Fouling>().fines_unit == 0);
            CHECK(text.find('\n') == std::string::npos);
            return text;
        };
        CHECK(refusal({.p4 = 120}) == "fouling: expected P4 from 0 to below 100 %, found 120");
        CHECK(refusal({.p4 = 1, .p200 = 2}) ==
              "fouling: expected P200 from 0 to P4, in %, found 2");
        CHECK(refusal({.p4 = 1, .saturation = 1.5}) ==
              "fouling: expected a saturation from 0 to 1, found 1.5");
        CHECK(refusal({.p4 = 90}).starts_with("fouling: expected P4 below "));
        World open = make_world(Grains::spheres);
        const auto material = add_material(open, {"rock", 2650, 1e6});
        add_sphere(open, Vec3::Zero(), 0.01, material);
        add_fouling(open, small);
        CHECK(refusal_of([&] {
                  fill_with_fines(open, {.p4 = 1});
              }).starts_with("fields: expected planes, a membrane or a box that bound"));
        World beside = make_world(Grains::spheres);
        beside.resource<Materials>() = open.resource<Materials>();
        add_sphere(beside, Vec3(1, 0, 0), 0.01, material);
        add_fouling(beside, small, {}, {Vec3::Zero(), Vec3::Constant(0.1)});
        CHECK(refusal_of([&] {
                  fill_with_fines(beside, {.p4 = 1});
              }).starts_with("fields: expected a space that covers all rocks, found body 0"));
        World world = make_world(Grains::spheres);
        CHECK(refusal_of([&] { add_fouling(world, {.voxel = 0}); }) ==
              "fouling: expected voxels above 0 m, found 0");
    }
}
