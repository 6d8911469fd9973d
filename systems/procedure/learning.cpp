#include "systems/procedure/learning.hpp"

#include "engine/errors.hpp"
#include "systems/fusion/parameter_estimate.hpp"
#include "systems/procedure/triaxial_results.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace bris {

namespace {

constexpr double no_stress = 1e3; // Pa, below which a logarithm of q says nothing
constexpr double compaction = 1e-3; // volumetric strain that grains take up before they dilate
constexpr double volume_noise = 0.02; // of volumetric strain as measured, relative
// What makes a specimen strong makes it dilate and widen too: among eleven of friction 0.7 ln q and dilation go together with a
// correlation of 0.6 to 0.9, and each goes on as it began with about this memory (tests/performance/packing_campaign).
constexpr SpecimenLikeness specimen_likeness{.memory = 4, .channels = 0.6}; // the former of ln strain

/// What is measured of a test and foretold by worlds: channels of the estimate.
enum Channel : std::size_t { strength, widening, dilation, channels };

using Measured = std::vector<double> MeasuredTest::*;

/// One stage of a run made of those of several: sums with weights.
void add_blend(ModelRun& sum, const Worlds& worlds, const Vector& weights, std::size_t stage) {
    TriaxialPoint point;
    const ModelRun& like = worlds.runs.front();
    point.ring_radius.assign(like.points[stage].ring_radius.size(), 0);
    std::vector<Vec3> displacement(like.rocks.size(), Vec3::Zero()), rotation = displacement;
    for (std::size_t j = 0; j < worlds.runs.size(); ++j) {
        const double w = weights[static_cast<Eigen::Index>(j)];
        const ModelRun& run = worlds.runs[j];
        const TriaxialPoint& p = run.points[stage];
        point.axial_strain += w * p.axial_strain;
        point.volumetric_strain += w * p.volumetric_strain;
        point.deviatoric_stress += w * p.deviatoric_stress;
        for (std::size_t r = 0; r < point.ring_radius.size(); ++r) point.ring_radius[r] += w * p.ring_radius[r];
        for (std::size_t rock = 0; rock < displacement.size(); ++rock) {
            displacement[rock] += w * run.displacement[stage][rock];
            rotation[rock] += w * run.rotation[stage][rock];
        }
    }
    sum.points.push_back(point);
    sum.displacement.push_back(std::move(displacement));
    sum.rotation.push_back(std::move(rotation));
}

/// A sample of a sensor, and the stage of the worlds at its strain.
struct Heard { std::size_t sensor, sample, stage; };

/// Whether a sensor rock tells of widening: one in the middle does not.
bool stands_off_axis(const ModelRun& run, std::size_t sensor) {
    constexpr double middle = 0.02; // m
    return run.start[sensor].position.head<2>().norm() >= middle;
}

/// Mean displacement away from the axis of the sensor rocks heard of.
double outwards(const ModelRun& run, const std::vector<Heard>& heard, const std::function<Vec3(const Heard&)>& displacement) {
    double sum = 0;
    for (const Heard& h : heard) {
        Vec3 out = run.start[h.sensor].position;
        out.z() = 0;
        sum += displacement(h).dot(out.normalized());
    }
    return heard.empty() ? 0 : sum / static_cast<double>(heard.size());
}

/// Worlds to learn from, or some of them.
struct Panel {
    std::vector<RockBelief> beliefs;
    std::vector<const ModelRun*> runs;
};

/// Means over a window of strain: of what was measured, and of what each world foretold at the same strains.
struct Means {
    double measured = 0;
    Vector foretold;
};

/// Nothing: not measured there.
std::optional<Means> means_of(const Panel& worlds, const MeasuredTest& measured, Measured what, double TriaxialPoint::* foretold, double from, double to) {
    Means m{0, Vector::Zero(static_cast<Eigen::Index>(worlds.runs.size()))};
    double count = 0;
    for (std::size_t k = 0; k < measured.strain.size(); ++k) {
        if (measured.strain[k] <= from + 1e-9 || measured.strain[k] > to + 1e-9 || !std::isfinite((measured.*what)[k])) continue;
        const auto stage = stage_of_sample(*worlds.runs.front(), measured.strain[k]);
        if (!stage) continue;
        m.measured += (measured.*what)[k];
        for (std::size_t j = 0; j < worlds.runs.size(); ++j) m.foretold[static_cast<Eigen::Index>(j)] += worlds.runs[j]->points[*stage].*foretold;
        ++count;
    }
    if (count == 0) return {};
    m.measured /= count;
    m.foretold /= count;
    return m;
}

/// A displacement that no world comes near: ten deviations of the worlds and of the noise.
bool is_gross(const Panel& worlds, const Heard& h, const Vec3& found, double noise) {
    Vec3 mean = Vec3::Zero();
    double squares = 0;
    for (const ModelRun* run : worlds.runs) mean += run->displacement[h.stage][h.sensor] / static_cast<double>(worlds.runs.size());
    for (const ModelRun* run : worlds.runs) squares += (run->displacement[h.stage][h.sensor] - mean).squaredNorm();
    const double variance = squares / static_cast<double>(worlds.runs.size() - 1) + 3 * noise * noise;
    return (found - mean).squaredNorm() > 100 * variance;
}

/// The last sample of each sensor that has come by the end of a window and was taken in it; fewer than half of the sensors: none.
std::vector<Heard> heard_in(const Panel& worlds, const MeasuredTest& measured, double from, double to) {
    const ModelRun& like = *worlds.runs.front();
    std::vector<Heard> heard;
    std::size_t expected = 0;
    for (std::size_t s = 0; s < std::min(measured.ways.size(), like.sensors); ++s) {
        const SensorWay& way = measured.ways[s];
        if (way.strain.empty() || !stands_off_axis(like, s)) continue;
        ++expected;
        const auto after = std::upper_bound(way.strain.begin(), way.strain.end(), to - measured.lateness + 1e-9);
        for (auto k = after - way.strain.begin() - 1; k >= 0; --k) {
            const auto sample = static_cast<std::size_t>(k);
            if (way.strain[sample] <= from - measured.lateness + 1e-9) break;
            const auto stage = stage_of_sample(like, way.strain[sample]);
            if (!stage || !way.displacement[sample].allFinite()) continue;
            const Heard h{s, sample, *stage};
            if (is_gross(worlds, h, way.displacement[sample], measured.displacement_noise)) continue;
            heard.push_back(h);
            break;
        }
    }
    if (2 * heard.size() < expected) heard.clear();
    return heard;
}

/// ln q.
bool see_strength(ParameterEstimate& estimate, const Panel& worlds, const MeasuredTest& measured, const Learning& settings, double from, double to) {
    const auto q = means_of(worlds, measured, &MeasuredTest::q, &TriaxialPoint::deviatoric_stress, from, to);
    if (!q || !(q->measured > no_stress) || !(q->foretold.minCoeff() > no_stress)) return false;
    estimate.see(strength, q->foretold.array().log(), {std::log(q->measured), settings.force_noise, settings.specimen_scatter, std::log(to)});
    return true;
}

/// How far the sensor rocks have come outwards. Specimens differ by a share of it.
bool see_sensors(ParameterEstimate& estimate, const Panel& worlds, const MeasuredTest& measured, const Learning& settings, double from, double to) {
    const std::vector<Heard> heard = heard_in(worlds, measured, from, to);
    if (heard.empty()) return false;
    Vector foretold(static_cast<Eigen::Index>(worlds.runs.size()));
    for (std::size_t j = 0; j < worlds.runs.size(); ++j)
        foretold[static_cast<Eigen::Index>(j)] = outwards(*worlds.runs[j], heard, [&](const Heard& h) { return worlds.runs[j]->displacement[h.stage][h.sensor]; });
    const double found = outwards(*worlds.runs.front(), heard, [&](const Heard& h) { return measured.ways[h.sensor].displacement[h.sample]; });
    const double noise = measured.displacement_noise / std::sqrt(static_cast<double>(heard.size()));
    estimate.see(widening, foretold, {found, noise, settings.specimen_scatter * foretold.cwiseAbs().mean(), std::log(to)});
    return true;
}

/// Dilation, in units that grow with strain as what specimens differ by does.
bool see_volume(ParameterEstimate& estimate, const Panel& worlds, const MeasuredTest& measured, const Learning& settings, double from, double to) {
    const auto volume = means_of(worlds, measured, &MeasuredTest::volumetric_strain, &TriaxialPoint::volumetric_strain, from, to);
    if (!volume) return false;
    const double size = std::abs(volume->foretold.mean()), unit = -(size + compaction); // compression is positive
    if (!(size > compaction)) return false; // all specimens begin alike: that would seem to say that this one goes on like the worlds
    estimate.see(dilation, volume->foretold / unit, {volume->measured / unit, volume_noise, settings.specimen_scatter, std::log(to)});
    return true;
}

enum class Asked { every_window, the_end };

/// `left_out`: worlds that the panel lacks.
std::vector<KnownAt> learn_trusting(const Gaussian& prior, const Panel& worlds, const MeasuredTest& measured, const Learning& settings, double final_strain, double trust,
                                    Asked asked, Eigen::Index left_out = 0) {
    ParameterEstimate estimate(prior, logarithms_of(worlds.beliefs), channels, trust, left_out, specimen_likeness);
    std::vector<KnownAt> known;
    double from = 0;
    for (const double to : window_ends(settings, final_strain)) {
        bool says_something = see_strength(estimate, worlds, measured, settings, from, to);
        const double distance = says_something ? estimate.surprise(strength) : -1;
        if (settings.by_sensors && see_sensors(estimate, worlds, measured, settings, from, to)) says_something = true;
        if (settings.by_volume && see_volume(estimate, worlds, measured, settings, from, to)) says_something = true;
        if (says_something && asked == Asked::every_window) known.push_back({to, estimate.parameters(), distance});
        from = to;
    }
    if (asked == Asked::the_end) known.push_back({final_strain, estimate.parameters(), -1});
    return known;
}

/// What would have been measured of a world, at the strains of a real test.
MeasuredTest as_measured(const ModelRun& run, const MeasuredTest& like) {
    MeasuredTest m = like;
    for (std::size_t k = 0; k < m.strain.size(); ++k) {
        const auto stage = stage_of_sample(run, m.strain[k]);
        m.q[k] = stage ? run.points[*stage].deviatoric_stress : std::nan("");
        if (std::isfinite(m.volumetric_strain[k])) m.volumetric_strain[k] = stage ? run.points[*stage].volumetric_strain : std::nan("");
    }
    for (std::size_t s = 0; s < m.ways.size() && s < run.sensors; ++s)
        for (std::size_t k = 0; k < m.ways[s].strain.size(); ++k) {
            const auto stage = stage_of_sample(run, m.ways[s].strain[k]);
            if (stage) m.ways[s].displacement[k] = run.displacement[*stage][s];
        }
    return m;
}

/// How far the worlds themselves can be trusted: each in turn is taken for the truth and its parameters learned from the
/// others. Where they come out farther off than they should, chaos lasts longer than a correlation from one time to the
/// next tells, and measurements count for less. With no world to spare that is not tried.
double trust_in(const Gaussian& prior, const Panel& worlds, const MeasuredTest& measured, const Learning& settings, double final_strain) {
    if (worlds.runs.size() <= ParameterEstimate::fewest_worlds) return 1;
    Learning same_specimen = settings;
    same_specimen.specimen_scatter = 0;
    double sum = 0;
    for (std::size_t j = 0; j < worlds.runs.size(); ++j) {
        Panel others = worlds;
        others.beliefs.erase(others.beliefs.begin() + static_cast<std::ptrdiff_t>(j));
        others.runs.erase(others.runs.begin() + static_cast<std::ptrdiff_t>(j));
        const auto known = learn_trusting(prior, others, as_measured(*worlds.runs[j], measured), same_specimen, final_strain, 1, Asked::the_end, 1);
        sum += squared_distance(known.back().belief, logarithms_of(worlds.beliefs[j]));
    }
    return std::min(1.0, 2 * static_cast<double>(worlds.runs.size()) / sum);
}

} // namespace

std::optional<std::size_t> stage_of_sample(const ModelRun& run, double strain) {
    if (run.points.size() < 2) return {};
    return stage_at(run.points, strain, 0.501 * (run.points[1].axial_strain - run.points[0].axial_strain));
}

MeasuredTest measured_test(const std::vector<TriaxialPoint>& points) {
    MeasuredTest s;
    for (const TriaxialPoint& p : points) {
        s.strain.push_back(p.axial_strain);
        s.q.push_back(p.deviatoric_stress);
        s.volumetric_strain.push_back(p.volumetric_strain);
    }
    return s;
}

MeasuredTest measured_test(const RecordedTest& test) {
    MeasuredTest s = measured_test(test.measured);
    s.ways = test.ways;
    double squares = 0;
    for (const Recording& r : test.recordings) squares += r.info.displacement_noise * r.info.displacement_noise;
    s.displacement_noise = std::sqrt(squares / static_cast<double>(test.recordings.size()));
    return s;
}

Vector logarithms_of(const RockBelief& rocks) {
    Vector v(2);
    v << std::log(rocks.friction), std::log(rocks.stiffness);
    return v;
}

Matrix logarithms_of(const std::vector<RockBelief>& beliefs) {
    Matrix logarithms(static_cast<Eigen::Index>(beliefs.size()), 2);
    for (std::size_t j = 0; j < beliefs.size(); ++j) logarithms.row(static_cast<Eigen::Index>(j)) = logarithms_of(beliefs[j]).transpose();
    return logarithms;
}

RockBelief mean_of(const Gaussian& belief) { return {std::exp(belief.mean[0]), std::exp(belief.mean[1])}; }

Gaussian prior_of(const RockBelief& middle, const Learning& settings) {
    Gaussian prior(2);
    prior.mean = logarithms_of(middle);
    prior.root.diagonal() << settings.friction_deviation, settings.stiffness_deviation;
    return prior;
}

std::vector<RockBelief> beliefs_of_worlds(const Gaussian& belief, unsigned worlds) {
    // multiples of two numbers whose fractions fill the square evenly (Roberts 2018), then as Box and Muller's pairs
    constexpr double g = 1.32471795724474602596;
    std::vector<RockBelief> beliefs;
    for (unsigned k = 1; k <= worlds; ++k) {
        const double u = std::fmod(0.5 + k / g, 1.0), v = std::fmod(0.5 + k / (g * g), 1.0), radius = std::sqrt(-2 * std::log(1 - u));
        const double x = radius * std::cos(2 * pi * v), y = radius * std::sin(2 * pi * v);
        beliefs.push_back({std::exp(belief.mean[0] + belief.root(0, 0) * x), std::exp(belief.mean[1] + belief.root(1, 0) * x + belief.root(1, 1) * y)});
    }
    return beliefs;
}

std::vector<double> window_ends(const Learning& settings, double final_strain) {
    std::vector<double> ends;
    // narrow windows at first, where stiffness shows, then wide ones
    for (double from = 0; from < final_strain - 1e-9; from = ends.back())
        ends.push_back(std::min(from + std::clamp(0.5 * from, settings.first_window, settings.window), final_strain));
    return ends;
}

std::vector<KnownAt> learn(const Gaussian& prior, const Worlds& worlds, const MeasuredTest& measured, const Learning& settings, double final_strain) {
    require(worlds.runs.size() == worlds.beliefs.size(), fmt::format("worlds: expected {} runs, found {}", worlds.beliefs.size(), worlds.runs.size()));
    Panel panel{worlds.beliefs, {}};
    for (const ModelRun& run : worlds.runs) panel.runs.push_back(&run);
    return learn_trusting(prior, panel, measured, settings, final_strain, trust_in(prior, panel, measured, settings, final_strain), Asked::every_window);
}

Worlds run_worlds(const Gaussian& belief, const Learning& settings, const std::string& name, double strain, const RunModels& run) {
    Worlds worlds{beliefs_of_worlds(belief, settings.worlds), {}};
    std::vector<ModelArm> arms;
    for (const RockBelief& b : worlds.beliefs) arms.push_back({.name = fmt::format("{} world {} of {}", name, arms.size() + 1, settings.worlds), .rocks = b});
    worlds.runs = run(arms, strain);
    for (std::size_t j = worlds.runs.size(); j-- > 0;) {
        if (worlds.runs[j].stopped.empty()) continue;
        fmt::print("left out: {}\n", worlds.runs[j].stopped);
        if (worlds.runs.size() <= ParameterEstimate::fewest_worlds) throw SimulationError(worlds.runs[j].stopped);
        worlds.runs.erase(worlds.runs.begin() + static_cast<std::ptrdiff_t>(j));
        worlds.beliefs.erase(worlds.beliefs.begin() + static_cast<std::ptrdiff_t>(j));
    }
    return worlds;
}

Gaussian spread_around(const Gaussian& prior, const std::vector<KnownAt>& known) {
    Gaussian around = known.empty() ? prior : known.back().belief;
    const Vector deviation = around.root.rowwise().norm(), before = prior.root.rowwise().norm();
    around.root = Matrix((2 * deviation).cwiseMax(0.3 * before).cwiseMin(before).asDiagonal());
    return around;
}

Learned learn_in_two_generations(const Gaussian& prior, const MeasuredTest& measured, const Learning& settings, double strain, const RunModels& run) {
    Learned learned;
    learned.first = run_worlds(prior, settings, "first", settings.first_strain, run);
    learned.known = learn(prior, learned.first, measured, settings, settings.first_strain);
    learned.second = run_worlds(spread_around(prior, learned.known), settings, "second", strain, run);
    const auto later = learn(prior, learned.second, measured, settings, std::min(settings.final_strain, strain)); // what the first generation saw is seen anew
    std::erase_if(learned.known, [&](const KnownAt& k) { return k.strain >= settings.first_strain - 1e-9; });
    for (const KnownAt& k : later)
        if (k.strain >= settings.first_strain - 1e-9) learned.known.push_back(k);
    return learned;
}

std::vector<LearnedBelief> schedule_of(const std::vector<KnownAt>& known, const RockBelief& first, double change) {
    std::vector<LearnedBelief> schedule;
    RockBelief last = first;
    for (const KnownAt& k : known) {
        const RockBelief now = mean_of(k.belief);
        const Matrix covariance = k.belief.covariance();
        const auto changed = [&](double before, double after, Eigen::Index p) { return std::abs(std::log(after / before)) > std::max(change, std::sqrt(covariance(p, p))); };
        if (!changed(last.friction, now.friction, 0) && !changed(last.stiffness, now.stiffness, 1)) continue;
        schedule.push_back({k.strain, now});
        last = now;
    }
    return schedule;
}

ModelRun begun_like(const ModelRun& run) {
    ModelRun begun;
    begun.rocks = run.rocks;
    begun.sensors = run.sensors;
    begun.start = run.start;
    begun.shell = run.shell;
    return begun;
}

void foretell(ModelRun& sum, const Worlds& worlds, const Vector& at) {
    add_blend(sum, worlds, WorldRegression(logarithms_of(worlds.beliefs)).weights_at(at), sum.points.size());
}

ModelRun foretold_by(const Learned& learned, const Gaussian& prior) {
    const ModelRun& like = learned.second.runs.front();
    ModelRun sum = begun_like(like);
    for (const ModelRun& run : learned.second.runs) {
        sum.steps += run.steps;
        sum.wall_time += run.wall_time;
    }
    for (std::size_t stage = 0; stage < like.points.size(); ++stage) {
        const double strain = like.points[stage].axial_strain;
        Vector at = prior.mean;
        for (const KnownAt& k : learned.known)
            if (k.strain <= strain + 1e-9) at = k.belief.mean;
        const bool early = stage < learned.first.runs.front().points.size() - 1;
        foretell(sum, early ? learned.first : learned.second, at);
    }
    return sum;
}

} // namespace bris
