#include "engine/random.hpp"
#include "systems/procedure/live_model.hpp"
#include "tests/about.hpp"
#include "tests/systems/procedure/simple_point.hpp"

#include <doctest/doctest.h>

using namespace bris;

namespace {

/// A model of a few lines: q, and ways of a sensor rock and its neighbour by friction and stiffness; each world goes astray
/// in its own way, and neighbours together.
ModelRun simple_run(const RockBelief& rocks, double strain, std::uint64_t seed) {
    ModelRun run;
    Random random(seed, 11);
    const double push = 0.03 * random.normal();
    const Vec3 astray = 2e-4 * random.direction();
    for (int k = 0; k <= std::lround(strain / 1e-4); ++k) {
        run.points.push_back(testing::simple_point(rocks, k * 1e-4, push));
        const TriaxialPoint& p = run.points.back();
        const double way = p.axial_strain / 0.02;
        run.displacement.push_back({way * (Vec3(1e-3 * rocks.friction, 0, 0) + astray), way * (Vec3(1e-3 * rocks.friction, 0, 0) + 0.9 * astray), way * Vec3(0, 0, 1e-3)});
        run.rotation.emplace_back(3, Vec3::Zero());
    }
    run.rocks = {0, 1, 2};
    run.sensors = 1;
    run.start = {{Vec3(0.1, 0, 0), Quat::Identity()}, {Vec3(0.1, 0.03, 0), Quat::Identity()}, {Vec3(0, 0, 0.2), Quat::Identity()}};
    run.shell = {0, 1, 4};
    return run;
}

/// What had been recorded of a run at some strain.
RecordedTest recorded(const ModelRun& run, double strain) {
    RecordedTest test;
    test.recordings.emplace_back().info.displacement_noise = 1e-6;
    test.ways.emplace_back();
    for (std::size_t k = 0; k < run.points.size() && run.points[k].axial_strain <= strain + 1e-9; ++k) {
        test.measured.push_back(run.points[k]);
        if (k == 0 || k % 10 != 0) continue;
        test.ways[0].strain.push_back(run.points[k].axial_strain);
        test.ways[0].displacement.push_back(run.displacement[k][0]);
        test.ways[0].rotation.push_back(Vec3::Constant(std::nan("")));
        test.ways[0].tilt.push_back(Vec3::Constant(std::nan("")));
    }
    return test;
}

struct Case {
    static constexpr RockBelief rocks{0.7, 1}, believed{0.5, 1.3};
    ModelRun truth = simple_run(rocks, 0.02, 77);
    unsigned runs = 0;
    Learning learning;
    std::vector<double> lengths;

    LiveModel model(double final_strain = 0.02) {
        return LiveModel(believed, learning, 1e-4, final_strain, [this](const std::vector<ModelArm>& arms, double strain) {
            std::vector<ModelRun> all;
            lengths.push_back(strain);
            for (const ModelArm& arm : arms) all.push_back(simple_run(arm.rocks, strain, 100 + runs++));
            return all;
        });
    }
};

double off(const ModelRun& run, const ModelRun& truth, std::size_t rock) { return (run.displacement.back()[rock] - truth.displacement[run.points.size() - 1][rock]).norm(); }

} // namespace

TEST_SUITE("procedure/live_model") {
    TEST_CASE("a test is learned from stage by stage, and what its sensors tell corrects their neighbours") {
        Case c;
        LiveModel model = c.model();
        CHECK(c.runs == 8); // before any record
        while (!model.done()) model.next_stage(recorded(c.truth, model.next_strain()));
        CHECK(c.lengths == std::vector<double>{2e-3, 0.02});
        CHECK(model.state().points.size() == 201);
        CHECK(model.strain() == about(0.02));
        CHECK(std::abs(mean_of(model.belief()).friction - 0.7) < 0.05);
        CHECK(squared_distance(model.belief(), logarithms_of({0.7, 1})) < 9.2);
        for (std::size_t k = 1; k < model.known().size(); ++k) CHECK(model.known()[k].strain > model.known()[k - 1].strain);
        CHECK(off(model.state(), c.truth, 0) < 0.05 * off(model.forecast(), c.truth, 0));
        CHECK(off(model.state(), c.truth, 1) < 0.5 * off(model.forecast(), c.truth, 1));
        CHECK(std::abs(model.state().points.back().deviatoric_stress / c.truth.points.back().deviatoric_stress - 1) < 0.1);
    }

    TEST_CASE("what comes later changes nothing that was said, and without records the model goes on alone") {
        Case one, other;
        for (std::size_t k = 51; k < other.truth.points.size(); ++k) {
            other.truth.points[k].deviatoric_stress *= 2;
            other.truth.displacement[k][0] *= 2;
        }
        LiveModel a = one.model(), b = other.model();
        for (int k = 0; k <= 200; ++k) {
            a.next_stage(recorded(one.truth, a.next_strain()));
            b.next_stage(recorded(other.truth, b.next_strain()));
            if (k > 50) continue;
            CHECK(a.state().points.back().deviatoric_stress == b.state().points.back().deviatoric_stress);
            CHECK(a.state().displacement.back() == b.state().displacement.back());
        }
        CHECK(a.state().displacement.back() != b.state().displacement.back());
        Case silent;
        LiveModel quiet = silent.model();
        while (!quiet.done()) quiet.next_stage(recorded(silent.truth, std::min(0.005, quiet.next_strain())));
        CHECK(quiet.state().points.size() == 201);
        CHECK(quiet.known().back().strain <= 0.01);
        for (const Vec3& d : quiet.state().displacement.back()) CHECK(d.allFinite());
    }

    TEST_CASE("a test shorter than the first generation needs no second one") {
        Case c;
        LiveModel model = c.model(1e-3);
        while (!model.done()) model.next_stage(recorded(c.truth, model.next_strain()));
        CHECK(c.runs == 8);
        CHECK(model.state().points.size() == 11);
    }
}
