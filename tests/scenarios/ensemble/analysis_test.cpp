#include "engine/random.hpp"
#include "engine/signal/attitude.hpp"
#include "scenarios/ensemble/analysis.hpp"
#include "scenarios/ensemble/layouts.hpp"
#include "scenarios/ensemble/learning.hpp"
#include "scenarios/ensemble/twin.hpp"
#include "tests/about.hpp"

#include <doctest/doctest.h>

using namespace bris;

namespace {

constexpr std::size_t rocks = 216, sensors = 8;
constexpr double length = 0.05; // m, correlation length of the displacements

/// Rocks on a grid of 30 mm whose displacement is a random field with the correlation
/// exp(-distance / length), times the strain; for the sensor rocks also times `quietness`.
ModelRun random_run(std::uint64_t seed, double quietness = 1) {
    ModelRun run;
    run.sensors = sensors;
    for (std::size_t k = 0; k < rocks; ++k) {
        // the sensor rocks come first, at positions spread over the grid
        const std::size_t rank = k < sensors ? 27 * k + 13 : 0;
        run.rocks.push_back(static_cast<EntityId>(k));
        run.start.push_back({0.03 * Vec3(static_cast<double>((k + rank) % 6),
                                         static_cast<double>((k + rank) / 6 % 6),
                                         static_cast<double>((k + rank) % 216 / 36)),
                             Quat::Identity()});
    }
    for (std::size_t k = 0; k < sensors; ++k)
        run.start[k].position += Vec3(0.011, 0.012, 0.013); // no two rocks at one position
    Matrix alike(rocks, rocks);
    for (std::size_t a = 0; a < rocks; ++a)
        for (std::size_t b = 0; b < rocks; ++b)
            alike(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b)) =
                std::exp(-(run.start[a].position - run.start[b].position).norm() / length);
    const Matrix root = root_of<double>(alike);
    Random random(seed, 5);
    Matrix white(rocks, 6);
    for (Eigen::Index i = 0; i < white.rows(); ++i)
        for (Eigen::Index c = 0; c < 6; ++c) white(i, c) = random.normal();
    const Matrix field = root * white;
    for (int stage = 0; stage <= 10; ++stage) {
        run.curves.add_row()[quantity::axial_strain] = 1e-3 * stage;
        run.displacement.emplace_back();
        run.rotation.emplace_back();
        for (Eigen::Index r = 0; r < field.rows(); ++r) {
            const double size =
                1e-4 * stage * (static_cast<std::size_t>(r) < sensors ? quietness : 1);
            run.displacement.back().push_back(size * Vec3(field(r, 0), field(r, 1), field(r, 2)));
            run.rotation.back().push_back(1e-2 * stage *
                                          Vec3(field(r, 3), field(r, 4), field(r, 5)));
        }
    }
    return run;
}

double error(const ModelRun& run, const ModelRun& truth, std::size_t first, std::size_t last) {
    double sum = 0;
    for (std::size_t r = first; r < last; ++r)
        sum += (run.displacement.back()[r] - truth.displacement.back()[r]).squaredNorm();
    return std::sqrt(sum / static_cast<double>(last - first));
}

/// The spread of ten ensemble members with such fields, and their mean as the forecast.
struct ForecastOfField {
    RockScatter scatter;
    ModelRun forecast = random_run(1);
    ForecastOfField() {
        Ensemble members{draw_members(prior_of({}, {}), 10), {}};
        for (std::uint64_t j = 0; j < 10; ++j) members.runs.push_back(random_run(j + 1));
        scatter = scatter_of(members);
        for (auto* stages : {&forecast.displacement, &forecast.rotation})
            for (auto& stage : *stages) std::ranges::fill(stage, Vec3::Zero());
    }
};

} // namespace

TEST_SUITE("ensemble/analysis") {
    TEST_CASE("observations correct neighbouring rocks as far as the ensemble correlates them") {
        Ensemble members{draw_members(prior_of({}, {}), 10), {}};
        for (std::uint64_t j = 0; j < 10; ++j) members.runs.push_back(random_run(j + 1));
        ModelRun forecast = random_run(1);
        for (auto& stage : forecast.displacement)
            std::ranges::fill(stage, Vec3::Zero()); // the mean of the field
        for (auto& stage : forecast.rotation) std::ranges::fill(stage, Vec3::Zero());
        const ModelRun truth = random_run(99);
        std::vector<SensorTrajectory> trajectories(sensors);
        for (std::size_t s = 0; s < sensors; ++s)
            for (std::size_t k = 1; k <= 10; ++k) {
                trajectories[s].strain.push_back(truth.curves[quantity::axial_strain][k]);
                trajectories[s].displacement.push_back(truth.displacement[k][s]);
                trajectories[s].rotation.push_back(Vec3::Constant(std::nan("")));
            }
        const RockScatter scatter = scatter_of(members);
        const std::vector<std::size_t> hosts = sensor_rocks(truth);
        const ModelRun analysis =
            compute_analysis(forecast, scatter, {hosts, trajectories, 1e-6, 1e-6});
        CHECK(scatter.displacement.correlation.length == about(length).epsilon(0.35));
        CHECK(scatter.displacement.correlation.near == about(0.95).epsilon(0.2));
        CHECK(error(analysis, truth, 0, sensors) < 0.02 * error(forecast, truth, 0, sensors));
        CHECK(error(analysis, truth, sensors, rocks) <
              0.95 * error(forecast, truth, sensors, rocks));
        CHECK(analysis.rotation.back() == forecast.rotation.back()); // not measured
        CHECK(analysis.curves[quantity::axial_strain].back() ==
              forecast.curves[quantity::axial_strain].back());
        // observations with a very large noise change nothing
        const ModelRun vague = compute_analysis(forecast, scatter, {hosts, trajectories, 1e3, 1e3});
        CHECK(error(vague, forecast, 0, rocks) < 1e-9);
        // an outlier is rejected, and the sample before it is used
        std::vector<SensorTrajectory> wrong = trajectories;
        wrong[2].displacement[9] += Vec3(1, 0, 0);
        const ModelRun refused = compute_analysis(forecast, scatter, {hosts, wrong, 1e-6, 1e-6});
        CHECK(refused.displacement[9] == analysis.displacement[9]);
        CHECK((refused.displacement[10][2] - analysis.displacement[10][2]).norm() <
              0.2 * analysis.displacement[10][2].norm());
        // a sample is not used before its strain
        for (SensorTrajectory& trajectory : trajectories)
            trajectory.strain.assign(1, 1e-2), trajectory.displacement.resize(1),
                trajectory.rotation.resize(1);
        CHECK(compute_analysis(forecast, scatter, {hosts, trajectories, 1e-6, 1e-6})
                  .displacement[9] == forecast.displacement[9]);
    }

    TEST_CASE(
        "sensors that observe only tilt correct rotations about horizontal axes, and leave the "
        "yaw of the forecast") {
        const ModelRun truth = random_run(99);
        const ForecastOfField field;
        std::vector<SensorTrajectory> trajectories(sensors);
        for (std::size_t s = 0; s < sensors; ++s)
            for (std::size_t k = 1; k <= 10; ++k) {
                const Quat now = exponential_map(truth.rotation[k][s]) * truth.start[s].orientation;
                trajectories[s].strain.push_back(truth.curves[quantity::axial_strain][k]);
                trajectories[s].displacement.push_back(Vec3::Constant(std::nan("")));
                trajectories[s].rotation.push_back(Vec3::Constant(std::nan("")));
                trajectories[s].tilt.push_back(truth.start[s].orientation.conjugate() *
                                                   Vec3::UnitZ() -
                                               now.conjugate() * Vec3::UnitZ());
            }
        const ModelRun analysis = compute_analysis(field.forecast, field.scatter,
                                                   {sensor_rocks(truth), trajectories, 1e-4, 1e-6});
        for (std::size_t s = 0; s < sensors; ++s) {
            // rotations of 0.01 rad: the second order is the square of that
            const Vec3 turn = truth.rotation[1][s], found = analysis.rotation[1][s];
            CHECK((found - turn).head<2>().norm() < 2 * turn.squaredNorm());
            CHECK(std::abs(found.z()) < 1e-12);
        }
        CHECK(analysis.displacement == field.forecast.displacement);
        CHECK(analysis.accepted == 10 * sensors);
    }

    TEST_CASE("sensors of a specimen that departs from the ensemble are detected and left out, and "
              "none of forty specimens that do not") {
        const ForecastOfField field;
        unsigned inconsistent = 0;
        double distance = 0;
        constexpr unsigned specimens = 40;
        for (std::uint64_t seed = 100; seed < 100 + specimens; ++seed) {
            const ModelRun truth = random_run(seed);
            const auto trajectories =
                recorded_trajectories(truth, sensor_rocks(truth), 1e-3, 1e-6, 1e-5, seed);
            const ModelRun analysis = compute_analysis(
                field.forecast, field.scatter, {sensor_rocks(truth), trajectories, 1e-6, 1e-5});
            inconsistent += analysis.inconsistent_from > 0 ? 1 : 0;
            for (const AnalysisRecord& r : analysis.analyses)
                distance += r.position_normalised_innovation_squared /
                            static_cast<double>(specimens * analysis.analyses.size());
            CHECK(analysis.accepted + analysis.refused == 2 * sensors * 10);
        }
        CHECK(inconsistent == 0);
        CHECK(distance > 2.5); // 3 expected; deviations from ten members add up to a tenth
        CHECK(distance < 4);
        // a specimen whose rocks depart from the forecast four times as far as those of the members
        ModelRun other = random_run(77);
        for (auto& stage : other.displacement)
            for (Vec3& u : stage) u *= 4;
        const auto trajectories =
            recorded_trajectories(other, sensor_rocks(other), 1e-3, 1e-6, 1e-5, 77);
        const ModelRun analysis = compute_analysis(field.forecast, field.scatter,
                                                   {sensor_rocks(other), trajectories, 1e-6, 1e-5});
        CHECK(analysis.inconsistent_from == about(3e-3));
        // two samples are not enough for a verdict
        CHECK(analysis.displacement[2] != field.forecast.displacement[2]);
        CHECK(analysis.displacement[3] == field.forecast.displacement[3]);
        CHECK(analysis.displacement.back() == field.forecast.displacement.back());
        CHECK(analysis.analyses.size() == 3 * sensors);
        // three sensors are too few for a verdict: all of them may depart from the forecast
        const std::vector<std::size_t> hosts{0, 1, 2};
        const std::vector<SensorTrajectory> of_three(trajectories.begin(),
                                                     trajectories.begin() + 3);
        CHECK(compute_analysis(field.forecast, field.scatter, {hosts, of_three, 1e-6, 1e-5})
                  .inconsistent_from == 0);
    }

    TEST_CASE("an observation that is less certain than the forecast of its rock does not increase "
              "the error") {
        // the sensor rocks scatter by 0.1 mm at the end, all others by 1 mm
        constexpr double quietness = 0.1;
        Ensemble members{draw_members(prior_of({}, {}), 10), {}};
        for (std::uint64_t j = 0; j < 10; ++j) members.runs.push_back(random_run(j + 1, quietness));
        ModelRun forecast = random_run(1);
        for (auto& stage : forecast.displacement) std::ranges::fill(stage, Vec3::Zero());
        const ModelRun truth = random_run(99, quietness);
        const std::vector<std::size_t> hosts = sensor_rocks(truth);
        const auto left_with = [&](double noise) {
            const auto trajectories = recorded_trajectories(truth, hosts, 1e-3, noise, 1e-3, 7);
            return error(compute_analysis(forecast, scatter_of(members),
                                          {hosts, trajectories, noise, 1e-3}),
                         truth, 0, sensors) /
                   error(forecast, truth, 0, sensors);
        };
        // optimal weights leave 0.98; weights from the mean deviation of all rocks would leave 4
        CHECK(left_with(5e-4) < 1.05);
        CHECK(left_with(5e-5) < 0.6); // optimal weights leave 0.45
    }
}
