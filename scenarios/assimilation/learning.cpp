#include "scenarios/assimilation/learning.hpp"

#include "engine/errors.hpp"
#include "engine/estimation/parameter_estimate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

namespace bris {

namespace {

constexpr double no_stress = 1e3;     // Pa, below which a logarithm of q says nothing
constexpr double compaction = 1e-3;   // volumetric strain that grains take up before they dilate
constexpr double volume_noise = 0.02; // of volumetric strain as measured, relative
constexpr double slip = 0.35;         // of ln q: worlds slip, too, but not when the specimen does
constexpr double gross = 6; // deviations of q; no world of the twin campaign is 3 from the others
// What makes a specimen strong makes it dilate and widen too: among eleven of friction 0.7 ln q and
// dilation go together with a correlation of 0.6 to 0.9, and each goes on as it began with about
// this memory (tests/performance/packing_campaign).
constexpr SpecimenLikeness specimen_likeness{.memory = 4,
                                             .channels = 0.6}; // the former of ln strain

/// What is measured of a test and foretold by worlds: channels of the estimate.
enum Channel : std::size_t { strength, widening, dilation, channels };

using Measured = std::vector<double> MeasuredTest::*;

/// A sample of a sensor, and the stage of the worlds at its strain.
struct Heard {
    std::size_t sensor, sample, stage;
};

/// Whether a sensor rock tells of widening: one in the middle does not.
bool stands_off_axis(const ModelRun& run, std::size_t sensor) {
    constexpr double middle = 0.02; // m
    return run.start[sensor].position.head<2>().norm() >= middle;
}

/// Mean displacement away from the axis of the sensor rocks heard of.
double outwards(const ModelRun& run, const std::vector<Heard>& heard,
                const std::function<Vec3(const Heard&)>& displacement) {
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

/// Means over a window of strain: of what was measured, and of what each world foretold at the same
/// strains.
struct Means {
    double measured = 0;
    Vector foretold;
};

/// What every world foretold of a stage.
Vector foretold_at(const Panel& worlds, std::size_t stage, double TriaxialPoint::*what) {
    return Vector::NullaryExpr(static_cast<Eigen::Index>(worlds.runs.size()), [&](Eigen::Index j) {
        return worlds.runs[static_cast<std::size_t>(j)]->points[stage].*what;
    });
}

/// Nothing: not measured there.
std::optional<Means> means_of(const Panel& worlds, const MeasuredTest& measured, Measured what,
                              double TriaxialPoint::*foretold, double from, double to) {
    Means m{0, Vector::Zero(static_cast<Eigen::Index>(worlds.runs.size()))};
    double count = 0;
    for (std::size_t k = 0; k < measured.strain.size(); ++k) {
        if (measured.strain[k] <= from + 1e-9 || measured.strain[k] > to + 1e-9 ||
            !std::isfinite((measured.*what)[k]))
            continue;
        const auto stage = stage_of_sample(*worlds.runs.front(), measured.strain[k]);
        if (!stage) continue;
        m.measured += (measured.*what)[k];
        m.foretold += foretold_at(worlds, *stage, foretold);
        ++count;
    }
    if (count == 0) return {};
    m.measured /= count;
    m.foretold /= count;
    return m;
}

/// Whether no world comes near ln q, whatever specimens differ by.
bool is_gross(double found, const Vector& foretold, double specimen_scatter) {
    const double mean = foretold.mean(), scatter = std::max(specimen_scatter, slip);
    const double variance =
        (foretold.array() - mean).square().sum() / static_cast<double>(foretold.size() - 1) +
        scatter * scatter;
    return std::pow(found - mean, 2) > gross * gross * variance;
}

/// The test without what is gross of q.
MeasuredTest cleaned(const Panel& worlds, const MeasuredTest& measured, const Learning& settings) {
    MeasuredTest m = measured;
    for (std::size_t k = 0; k < m.strain.size(); ++k) {
        const auto stage = stage_of_sample(*worlds.runs.front(), m.strain[k]);
        if (!stage || !(m.strain[k] > 1e-9) || !(m.q[k] > no_stress)) continue;
        const Vector foretold = foretold_at(worlds, *stage, &TriaxialPoint::deviatoric_stress);
        if (!(foretold.minCoeff() > no_stress) ||
            !is_gross(std::log(m.q[k]), foretold.array().log(), settings.specimen_scatter))
            continue;
        m.q[k] = std::nan("");
        m.left_out.push_back(m.strain[k]);
    }
    return m;
}

/// A displacement that no world comes near: ten deviations of the worlds and of the noise.
bool is_gross(const Panel& worlds, const Heard& h, const Vec3& found, double noise) {
    Vec3 mean = Vec3::Zero();
    double squares = 0;
    for (const ModelRun* run : worlds.runs)
        mean += run->displacement[h.stage][h.sensor] / static_cast<double>(worlds.runs.size());
    for (const ModelRun* run : worlds.runs)
        squares += (run->displacement[h.stage][h.sensor] - mean).squaredNorm();
    const double variance =
        squares / static_cast<double>(worlds.runs.size() - 1) + 3 * noise * noise;
    return (found - mean).squaredNorm() > 100 * variance;
}

/// The last sample of each sensor that has come by the end of a window and was taken in it; fewer
/// than half of the sensors: none.
std::vector<Heard> heard_in(const Panel& worlds, const MeasuredTest& measured, double from,
                            double to) {
    const ModelRun& like = *worlds.runs.front();
    std::vector<Heard> heard;
    std::size_t expected = 0;
    for (std::size_t s = 0; s < std::min(measured.ways.size(), like.sensors); ++s) {
        const SensorWay& way = measured.ways[s];
        if (way.strain.empty() || !stands_off_axis(like, s)) continue;
        ++expected;
        const auto after =
            std::upper_bound(way.strain.begin(), way.strain.end(), to - measured.lateness + 1e-9);
        for (auto k = after - way.strain.begin() - 1; k >= 0; --k) {
            const auto sample = static_cast<std::size_t>(k);
            if (way.strain[sample] <= from - measured.lateness + 1e-9) break;
            const auto stage = stage_of_sample(like, way.strain[sample]);
            if (!stage || !way.displacement[sample].allFinite()) continue;
            const Heard h{s, sample, *stage};
            if (is_gross(worlds, h, way.displacement[sample], measured.displacement_noise))
                continue;
            heard.push_back(h);
            break;
        }
    }
    if (2 * heard.size() < expected) heard.clear();
    return heard;
}

/// ln q.
bool see_strength(ParameterEstimate& estimate, const Panel& worlds, const MeasuredTest& measured,
                  const Learning& settings, double from, double to) {
    const auto q =
        means_of(worlds, measured, &MeasuredTest::q, &TriaxialPoint::deviatoric_stress, from, to);
    if (!q || !(q->measured > no_stress) || !(q->foretold.minCoeff() > no_stress)) return false;
    estimate.see(
        strength, q->foretold.array().log(),
        {std::log(q->measured), settings.force_noise, settings.specimen_scatter, std::log(to)});
    return true;
}

/// How far the sensor rocks have come outwards. Specimens differ by a share of it.
bool see_sensors(ParameterEstimate& estimate, const Panel& worlds, const MeasuredTest& measured,
                 const Learning& settings, double from, double to) {
    const std::vector<Heard> heard = heard_in(worlds, measured, from, to);
    if (heard.empty()) return false;
    Vector foretold(static_cast<Eigen::Index>(worlds.runs.size()));
    for (std::size_t j = 0; j < worlds.runs.size(); ++j)
        foretold[static_cast<Eigen::Index>(j)] =
            outwards(*worlds.runs[j], heard, [&](const Heard& h) {
                return worlds.runs[j]->displacement[h.stage][h.sensor];
            });
    const double found = outwards(*worlds.runs.front(), heard, [&](const Heard& h) {
        return measured.ways[h.sensor].displacement[h.sample];
    });
    const double noise = measured.displacement_noise / std::sqrt(static_cast<double>(heard.size()));
    estimate.see(
        widening, foretold,
        {found, noise, settings.specimen_scatter * foretold.cwiseAbs().mean(), std::log(to)});
    return true;
}

/// Dilation, in units that grow with strain as what specimens differ by does.
bool see_volume(ParameterEstimate& estimate, const Panel& worlds, const MeasuredTest& measured,
                const Learning& settings, double from, double to) {
    const auto volume = means_of(worlds, measured, &MeasuredTest::volumetric_strain,
                                 &TriaxialPoint::volumetric_strain, from, to);
    if (!volume) return false;
    const double size = std::abs(volume->foretold.mean()),
                 unit = -(size + compaction); // compression is positive
    if (!(size > compaction))
        return false; // all specimens begin alike: that would seem to say that this one goes on
                      // like the worlds
    estimate.see(dilation, volume->foretold / unit,
                 {volume->measured / unit, volume_noise, settings.specimen_scatter, std::log(to)});
    return true;
}

enum class Asked { every_window, the_end };

/// `left_out`: worlds that the panel lacks.
std::vector<KnownAt> learn_trusting(const Gaussian& prior, const Panel& worlds,
                                    const MeasuredTest& measured, const Learning& settings,
                                    double final_strain, double trust, Asked asked,
                                    Eigen::Index left_out = 0) {
    ParameterEstimate estimate(prior, logarithms_of(worlds.beliefs), channels, trust, left_out,
                               specimen_likeness);
    std::vector<KnownAt> known;
    double from = 0;
    for (const double to : window_ends(settings, final_strain)) {
        bool says_something =
            settings.by_force && see_strength(estimate, worlds, measured, settings, from, to);
        const double distance = says_something ? estimate.surprise(strength) : -1;
        if (settings.by_sensors && see_sensors(estimate, worlds, measured, settings, from, to))
            says_something = true;
        if (settings.by_volume && see_volume(estimate, worlds, measured, settings, from, to))
            says_something = true;
        const auto left_out_here =
            static_cast<unsigned>(std::ranges::count_if(measured.left_out, [&](double strain) {
                return strain > from + 1e-9 && strain <= to + 1e-9;
            }));
        if ((says_something || left_out_here > 0) && asked == Asked::every_window)
            known.push_back({to, estimate.parameters(), distance, left_out_here});
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
        if (std::isfinite(m.q[k]))
            m.q[k] = stage ? run.points[*stage].deviatoric_stress : std::nan("");
        if (std::isfinite(m.volumetric_strain[k]))
            m.volumetric_strain[k] = stage ? run.points[*stage].volumetric_strain : std::nan("");
    }
    for (std::size_t s = 0; s < m.ways.size() && s < run.sensors; ++s)
        for (std::size_t k = 0; k < m.ways[s].strain.size(); ++k) {
            const auto stage = stage_of_sample(run, m.ways[s].strain[k]);
            if (stage && m.ways[s].displacement[k].allFinite())
                m.ways[s].displacement[k] = run.displacement[*stage][s];
        }
    return m;
}

/// How far the worlds themselves can be trusted: each in turn is taken for the truth and its
/// parameters learned from the others. Where they come out farther off than they should, chaos
/// lasts longer than a correlation from one time to the next tells, and measurements count for
/// less. With no world to spare that is not tried.
double trust_in(const Gaussian& prior, const Panel& worlds, const MeasuredTest& measured,
                const Learning& settings, double final_strain) {
    if (worlds.runs.size() <= ParameterEstimate::fewest_worlds) return 1;
    Learning same_specimen = settings;
    same_specimen.specimen_scatter = 0;
    double sum = 0;
    for (std::size_t j = 0; j < worlds.runs.size(); ++j) {
        Panel others = worlds;
        others.beliefs.erase(others.beliefs.begin() + static_cast<std::ptrdiff_t>(j));
        others.runs.erase(others.runs.begin() + static_cast<std::ptrdiff_t>(j));
        const auto known = learn_trusting(prior, others, as_measured(*worlds.runs[j], measured),
                                          same_specimen, final_strain, 1, Asked::the_end, 1);
        sum += squared_distance(known.back().belief, logarithms_of(worlds.beliefs[j]));
    }
    return std::min(1.0, 2 * static_cast<double>(worlds.runs.size()) / sum);
}

Panel panel_of(const Worlds& worlds) {
    require(worlds.runs.size() == worlds.beliefs.size(),
            fmt::format("worlds: expected {} runs, found {}", worlds.beliefs.size(),
                        worlds.runs.size()));
    Panel panel{worlds.beliefs, {}};
    for (const ModelRun& run : worlds.runs) panel.runs.push_back(&run);
    return panel;
}

} // namespace

Gaussian prior_of(const RockBelief& middle, const Learning& settings) {
    Gaussian prior(2);
    prior.mean = logarithms_of(middle);
    prior.root.diagonal() << settings.friction_deviation, settings.stiffness_deviation;
    return prior;
}

std::vector<double> window_ends(const Learning& settings, double final_strain) {
    std::vector<double> ends;
    // narrow windows at first, where stiffness shows, then wide ones
    for (double from = 0; from < final_strain - 1e-9; from = ends.back())
        ends.push_back(std::min(
            from + std::clamp(0.5 * from, settings.first_window, settings.window), final_strain));
    return ends;
}

std::vector<KnownAt> learn(const Gaussian& prior, const Worlds& worlds,
                           const MeasuredTest& measured, const Learning& settings,
                           double final_strain) {
    const Panel panel = panel_of(worlds);
    const MeasuredTest test = cleaned(panel, measured, settings);
    return learn_trusting(prior, panel, test, settings, final_strain,
                          trust_in(prior, panel, test, settings, final_strain),
                          Asked::every_window);
}

std::size_t gross_displacements(const Worlds& worlds, const MeasuredTest& measured) {
    const Panel panel = panel_of(worlds);
    std::size_t gross = 0;
    for (std::size_t s = 0; s < std::min(measured.ways.size(), worlds.runs.front().sensors); ++s)
        for (std::size_t k = 0; k < measured.ways[s].strain.size(); ++k) {
            const Vec3& found = measured.ways[s].displacement[k];
            const auto stage = stage_of_sample(worlds.runs.front(), measured.ways[s].strain[k]);
            if (stage && found.allFinite() &&
                is_gross(panel, {s, k, *stage}, found, measured.displacement_noise))
                ++gross;
        }
    return gross;
}

} // namespace bris
