#include "components/body.hpp"
#include "components/kinds.hpp"
#include "components/sphere.hpp"
#include "engine/errors.hpp"
#include "scenarios/ensemble/model_specimen.hpp"
#include "scenarios/specimens/growth.hpp"
#include "scenarios/specimens/scene.hpp"
#include "scenarios/triaxial/specimen_state.hpp"
#include "tests/about.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>

using namespace bris;

namespace {

const auto nobody_watches = [](const PhaseProgress&) {};

// 60 rocks, loosely packed: quickly made, with every mechanism
Triaxial small() {
    Triaxial t;
    t.bodies = 60;
    t.least_diameter = 1;
    t.test.porosity = 0.42;
    t.test.porosity_tolerance = 0.04;
    t.test.confining_pressure = 55e3;
    t.test.final_axial_strain = 2e-4;
    return t;
}

Common in(const std::filesystem::path& out) {
    Common common;
    common.out = out;
    common.threads = 1;
    common.settings.emplace_back("seed", common.seed);
    return common;
}

struct Truth {
    TemporaryDirectory folder;
    Common common = in(folder.path());
    Triaxial described = small();
    PreparedSpecimen specimen{make_scene(described, 1), {}};

    Truth() {
        specimen.state =
            make_specimen(specimen.scene, described.test, common, nobody_watches).state;
    }
    PreparedSpecimen model(const ModelMismatch& mismatch) const {
        return make_model_specimen(described, described.test, specimen, mismatch, common,
                                   nobody_watches);
    }
};

/// Made once, for all test cases.
const Truth& the_truth() {
    static const Truth truth;
    return truth;
}

Simulation restored(const PreparedSpecimen& specimen) {
    Simulation simulation = make_simulation(specimen.scene, 1);
    simulation.restore(specimen.state);
    return simulation;
}

std::vector<EntityId> all_rocks(const World& world) {
    std::vector<EntityId> rocks = world.resource<Specimen>().smart_rocks;
    rocks.insert(rocks.end(), world.resource<Specimen>().rocks.begin(),
                 world.resource<Specimen>().rocks.end());
    return rocks;
}

/// Root mean square distance (m) of rocks in one specimen from those in another.
double apart(Simulation& a, Simulation& b) {
    double squares = 0;
    const auto rocks = all_rocks(a.world());
    for (const EntityId id : rocks)
        squares += (value_of<Position>(a, id) - value_of<Position>(b, id)).squaredNorm();
    return std::sqrt(squares / static_cast<double>(rocks.size()));
}

void check_same_masses(Simulation& simulation, Simulation& before) {
    for (const EntityId id : all_rocks(before.world())) {
        CHECK(value_of<Mass>(simulation, id) == value_of<Mass>(before, id));
        CHECK(value_of<Inertia>(simulation, id) == value_of<Inertia>(before, id));
        CHECK(value_of<MotionOf>(simulation, id) == static_cast<std::uint32_t>(Motion::free));
    }
}

/// The largest overlap (m) in the next step, and the diameter (m) of the largest sphere.
struct Deepest {
    double overlap, diameter;
};
Deepest deepest(Simulation& simulation) {
    simulation.advance();
    double radius = 0;
    for (const Ball& ball : simulation.world().column<Spheres, LocalBall>())
        radius = std::max(radius, ball.radius);
    return {std::ranges::max(largest_overlaps(simulation.world())), 2 * radius};
}

} // namespace

TEST_SUITE("ensemble/model_specimen") {
    TEST_CASE(
        "rocks of a model start displaced from their true positions, in the same mould and with "
        "the same masses, and overlap by at most a hundredth of a sphere's diameter") {
        const Truth& truth = the_truth();
        Simulation before = restored(truth.specimen);
        for (const ModelMismatch& mismatch : {ModelMismatch{}, ModelMismatch{.placement = 1e-3},
                                              ModelMismatch{.placement = 2e-3, .rotation = 0.05}}) {
            CAPTURE(mismatch.name());
            Simulation simulation = make_simulation(truth.specimen.scene, 1);
            TriaxialTest test(simulation, truth.described.test);
            const Relaxed relaxed =
                fill_like(simulation, test, truth.specimen.scene, truth.specimen, mismatch, 1);
            CHECK(relaxed.done);
            CHECK(test.state().phase == TriaxialPhase::consolidate);
            const double distance = apart(simulation, before);
            if (mismatch.any()) CHECK(relaxed.first_overlap > 0.02);
            if (mismatch.placement > 0) {
                // some rocks are pushed back to where they came from
                CHECK(distance > 0.2 * mismatch.placement);
                CHECK(distance < 1.5 * mismatch.placement);
            }
            if (!mismatch.any()) CHECK(distance < 1e-4);
            CHECK(platen_height(simulation.world()) == platen_height(before.world()));
            CHECK(membrane_radius(simulation.world()) == membrane_radius(before.world()));
            check_same_masses(simulation, before);
            const Deepest d = deepest(simulation);
            CHECK(d.overlap > 0);
            CHECK(d.overlap <= 0.011 * d.diameter); // one step after relaxation
        }
    }

    TEST_CASE("a model of another specimen comes to rest at the same pressure and about the same "
              "density, and displacements are counted from its own start" *
              doctest::skip()) { // a minute
        const Truth& truth = the_truth();
        const PreparedSpecimen moved = truth.model({.placement = 2e-3}),
                               round = truth.model({.spheres = 8}),
                               other = truth.model({.packing = 7});
        Simulation true_one = restored(truth.specimen), rounder = restored(round);
        check_same_masses(rounder, true_one);
        CHECK(rounder.world().table<Spheres>().size() == 8 * truth.described.bodies);
        Progress progress(Progress::Style::quiet);
        const std::vector<const PreparedSpecimen*> specimens{&truth.specimen, &moved, &round,
                                                             &other};
        const std::vector<ModelVariant> variants{{.name = "truth", .rocks = {}},
                                                 {.name = "off", .rocks = {}},
                                                 {.name = "round", .rocks = {}},
                                                 {.name = "other", .rocks = {}}};
        const auto runs =
            run_models(specimens, truth.described.test, variants, 2e-4, truth.common, progress);
        for (std::size_t k = 0; k < runs.size(); ++k) {
            CAPTURE(variants[k].name);
            const auto start = [&](const Quantity& q) { return runs[k].curves[q].front(); };
            CHECK(start(quantity::worst_ring_error) <= truth.described.test.pressure_tolerance);
            CHECK(start(quantity::radial_stress) ==
                  about(truth.described.test.confining_pressure)
                      .epsilon(truth.described.test.pressure_tolerance));
            CHECK(start(quantity::unbalanced_ratio) <= truth.described.test.tolerance);
            // Rounder rocks yield: with 5 to 14 spheres for each the nine models are 0.017 to 0.042
            // denser than the truth. Of two packings each is within its own tolerance.
            const std::array most{0.0, 0.02, 0.05, 0.06};
            CHECK(std::abs(runs[k].core_porosity - runs[0].core_porosity) <= most[k]);
            for (const Vec3& u : runs[k].displacement.front()) CHECK(u == Vec3::Zero());
            CHECK(runs[k].sensors == runs[0].sensors);
        }
        CHECK(start_difference(runs[0], runs[0]).distance == 0);
        const StartDifference displaced = start_difference(runs[1], runs[0]),
                              packed = start_difference(runs[3], runs[0]);
        CHECK(displaced.distance > 0.4e-3);
        CHECK(displaced.distance < 6e-3);
        CHECK(displaced.angle > 0);
        // only the sensor rocks are at the positions of the truth
        CHECK(packed.distance > 5 * packed.sensor_distance);
    }

    TEST_CASE("a model's specimen is the same each time it is made, differs with the seed, and is "
              "read from where it was saved") {
        const Truth& truth = the_truth();
        const ModelMismatch displaced{.placement = 2e-3};
        Common common = truth.common;
        const auto made = [&] {
            return fingerprint(make_model_specimen(truth.described, truth.described.test,
                                                   truth.specimen, displaced, common,
                                                   nobody_watches)
                                   .state);
        };
        common.seed = 2;
        const auto other = made();
        common.seed = 1;
        const auto first = made();
        CHECK(other != first);
        CHECK(made() == first);
        // read from the folder: nothing is made again, so a wrong file there is an error
        common.resume = common.out;
        CHECK(made() == first);
        std::filesystem::copy_file(common.out / "specimen.ckpt.h5",
                                   common.out / displaced.name() / "specimen.ckpt.h5",
                                   std::filesystem::copy_options::overwrite_existing);
        CHECK_THROWS_AS(made(), InputError);
        CHECK(ModelMismatch{.placement = 2e-3}.name() == "model_2_mm");
        CHECK(ModelMismatch{.spheres = 8, .packing = 7}.name() == "model_packing_7_8_spheres");
    }

    TEST_CASE("the specimen scatter is zero without a mismatch, and largest for another packing") {
        CHECK(ModelMismatch{}.specimen_scatter() == 0);
        CHECK(ModelMismatch{.placement = 1e-3}.specimen_scatter() > 0);
        CHECK(ModelMismatch{.spheres = 8}.specimen_scatter() > 0);
        CHECK(ModelMismatch{.packing = 2}.specimen_scatter() >
              ModelMismatch{.spheres = 8}.specimen_scatter());
    }
}
