#include "scenarios/library/library_score.hpp"

#include "engine/ensemble.hpp"
#include "engine/errors.hpp"
#include "engine/estimation/normal_score.hpp"
#include "engine/estimation/student_t.hpp"
#include "engine/random.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace bris {

namespace {

using Block = LibraryTargets::Block;

/// Block of a scored quantity, and its strains: above the first, up to the second.
struct Part {
    Block block;
    double from, to;
};
Part part_of(Scored scored, double learned, double last) {
    constexpr std::array blocks{Block::q,          Block::q,          Block::q,
                                Block::smoothed_q, Block::smoothed_q, Block::smoothed_q,
                                Block::volume,     Block::volume,     Block::rings};
    const Block block = blocks[static_cast<std::size_t>(scored)];
    switch (scored) {
    case Scored::q_near:
    case Scored::smoothed_q_near:
    case Scored::volume_near:
        return {block, learned, last / 2};
    case Scored::q_far:
    case Scored::smoothed_q_far:
        return {block, last / 2, last};
    case Scored::rings_last:
        return {block, last * (1 - 1e-6), last};
    default:
        return {block, learned, last};
    }
}

/// Scores the prediction of one specimen.
class ScoreOfCase {
public:
    ScoreOfCase(const SpecimenLibrary& library, const LibraryTargets& targets,
                const Matrix& members, const HybridRegression& regression, const Vector& features,
                const Vector& truth)
        : library_(library), targets_(targets), members_(members), truth_(truth),
          predicted_(regression.predict(features)), prior_(regression.prior()),
          t_(student_t_quantile(0.95, regression.freedom())) {}

    SpecimenScore score(double learned) const;

private:
    QuantityScore score_of(const Part& part) const;
    double natural(Block block, double x) const {
        return block == Block::q || block == Block::smoothed_q ? std::exp(x) : x;
    }

    const SpecimenLibrary& library_;
    const LibraryTargets& targets_;
    const Matrix& members_; // targets of the library's specimens
    const Vector& truth_;
    HybridRegression::Prediction predicted_, prior_;
    double t_;
};

QuantityScore ScoreOfCase::score_of(const Part& part) const {
    QuantityScore s;
    const Eigen::Index width = targets_.width(part.block), first = targets_.column(0, part.block);
    Vector single = Vector::Zero(members_.rows());
    double count = 0;
    for (std::size_t k = 0; k < library_.axis.count; ++k) {
        const double strain = library_.axis.strain(k);
        if (strain < part.from * (1 + 1e-9) || strain > part.to * (1 + 1e-9)) continue;
        for (Eigen::Index w = 0; w < width; ++w, ++count) {
            const Eigen::Index c = first + static_cast<Eigen::Index>(k) * width + w;
            const double truth = natural(part.block, truth_[c]);
            s.error += std::pow(natural(part.block, predicted_.mean[c]) - truth, 2);
            s.prior += std::pow(natural(part.block, prior_.mean[c]) - truth, 2);
            for (Eigen::Index j = 0; j < members_.rows(); ++j)
                single[j] += std::pow(natural(part.block, members_(j, c)) - truth, 2);
            const double off = truth_[c] - predicted_.mean[c];
            s.inside += std::abs(off) <= t_ * predicted_.deviation[c] ? 1 : 0;
            s.crps += normal_crps(off, predicted_.deviation[c]);
            s.prior_crps += normal_crps(truth_[c] - prior_.mean[c], prior_.deviation[c]);
        }
    }
    s.error = std::sqrt(s.error / count);
    s.prior = std::sqrt(s.prior / count);
    s.single = (single / count).cwiseSqrt().mean();
    s.inside /= count;
    s.crps /= count;
    s.prior_crps /= count;
    return s;
}

SpecimenScore ScoreOfCase::score(double learned) const {
    SpecimenScore s;
    const double last = library_.axis.strain(library_.axis.count - 1);
    for (std::size_t k = 0; k < scored_count; ++k)
        s.of[k] = score_of(part_of(static_cast<Scored>(k), learned, last));
    s.distance = predicted_.distance;
    for (std::size_t k = 0; k < library_.axis.count; ++k) {
        const auto at = static_cast<Eigen::Index>(k);
        const Eigen::Index q = targets_.column(0, Block::q) + at,
                           volume = targets_.column(0, Block::volume) + at,
                           smooth = targets_.column(0, Block::smoothed_q) + at;
        s.q.push_back(predicted_.mean[q] - truth_[q]);
        s.prior_q.push_back(prior_.mean[q] - truth_[q]);
        s.volume.push_back(predicted_.mean[volume] - truth_[volume]);
        s.prior_volume.push_back(prior_.mean[volume] - truth_[volume]);
        if (library_.axis.strain(k) > learned * (1 + 1e-9))
            s.probabilities.push_back(normal_probability(
                (truth_[smooth] - predicted_.mean[smooth]) / predicted_.deviation[smooth]));
    }
    return s;
}

/// The regression over a library, with the targets of its specimens.
class Scorer {
public:
    Scorer(const SpecimenLibrary& library, const Scoring& scoring)
        : library_(library), scoring_(scoring), targets_(library, {scoring.predicted_at}, false),
          regression_(regression_of(library, scoring.observed, scoring.measured_at, targets_)),
          parameters_(parameter_regression_of(library, scoring.observed, scoring.measured_at)),
          members_(static_cast<Eigen::Index>(library.specimens.size()), targets_.count()) {
        for (std::size_t k = 0; k < library.specimens.size(); ++k)
            members_.row(static_cast<Eigen::Index>(k)) =
                targets_.values(library.specimens[k]).transpose();
    }
    /// The score of a specimen when the measurements of `measured` are assimilated.
    SpecimenScore score(const LibrarySpecimen& truth, const LibrarySpecimen& measured) const {
        const Vector values = targets_.values(truth);
        SpecimenScore s =
            ScoreOfCase(library_, targets_, members_, regression_,
                        features_of(library_, measured, scoring_.measured_at, scoring_.observed),
                        values)
                .score(scoring_.observed.strain);
        const auto p = parameters_.predict(
            parameter_features_of(library_, measured, scoring_.measured_at, scoring_.observed));
        s.friction = std::log(truth.rocks.friction);
        s.learned_friction = p.mean[ParameterColumn::ln_friction];
        s.friction_band = student_t_quantile(0.95, parameters_.freedom()) *
                          p.deviation[ParameterColumn::ln_friction];
        s.stiffness = std::log(truth.rocks.stiffness);
        s.learned_stiffness = p.mean[ParameterColumn::ln_stiffness];
        return s;
    }

private:
    const SpecimenLibrary& library_;
    const Scoring& scoring_;
    LibraryTargets targets_;
    HybridRegression regression_, parameters_;
    Matrix members_;
};

/// Number of the specimen whose measurements are used for the k-th of n.
std::size_t measured_for(std::size_t k, std::size_t n, bool sham) {
    return sham ? (k + n / 2) % n : k;
}

} // namespace

std::string name_of(Scored scored, double learned, double last) {
    constexpr std::array names{"q", "smoothed_q", "volume", "rings"};
    const Part part = part_of(scored, learned, last);
    const char* name = names[static_cast<std::size_t>(part.block)];
    if (scored == Scored::rings_last) return fmt::format("{}_at_{:g}_percent", name, 100 * last);
    return fmt::format("{}_{:g}_to_{:g}_percent", name, 100 * part.from, 100 * part.to);
}

std::vector<SpecimenScore> scores_within(const SpecimenLibrary& library, const Scoring& scoring) {
    const std::size_t n = library.specimens.size();
    std::vector<SpecimenScore> scores(n);
    run_ensemble(n, scoring.threads, [&](std::size_t k) {
        SpecimenLibrary others = library;
        const std::size_t measured = measured_for(k, n, scoring.sham);
        others.specimens.erase(others.specimens.begin() + static_cast<std::ptrdiff_t>(k));
        scores[k] =
            Scorer(others, scoring).score(library.specimens[k], library.specimens[measured]);
    });
    return scores;
}

std::vector<SpecimenScore> scores_outside(const SpecimenLibrary& library,
                                          const SpecimenLibrary& truths, const Scoring& scoring) {
    require(truths.pressures == library.pressures && truths.axis.count == library.axis.count &&
                std::abs(truths.axis.step - library.axis.step) < 1e-12 &&
                truths.rings == library.rings,
            "--truths: expected the pressures, strains and rings of the library, found others");
    const bool of_sensors = scoring.observed.tracked || scoring.observed.tilt;
    require(!of_sensors || truths.sensors == library.sensors,
            fmt::format("--truths: expected {} sensor rocks, as in the library, found {}",
                        library.sensors, truths.sensors));
    const std::size_t n = truths.specimens.size();
    std::vector<SpecimenScore> scores(n);
    const Scorer scorer(library, scoring);
    run_ensemble(n, scoring.threads, [&](std::size_t k) {
        scores[k] =
            scorer.score(truths.specimens[k], truths.specimens[measured_for(k, n, scoring.sham)]);
    });
    return scores;
}

RatioInterval geometric_mean(std::span<const double> ratios, std::uint64_t seed) {
    require(!ratios.empty(), "geometric mean: expected numbers, found none");
    constexpr std::size_t samples = 2000;
    const auto n = static_cast<double>(ratios.size());
    double mean = 0;
    for (const double r : ratios) mean += std::log(r) / n;
    Random random(seed, 99);
    std::vector<double> means(samples);
    for (double& m : means)
        for (std::size_t k = 0; k < ratios.size(); ++k)
            m += std::log(ratios[static_cast<std::size_t>(random.uniform() * n)]) / n;
    std::ranges::sort(means);
    return {std::exp(mean), std::exp(means[samples / 40]), std::exp(means[samples - samples / 40])};
}

} // namespace bris
