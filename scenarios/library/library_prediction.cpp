#include "scenarios/library/library_prediction.hpp"

#include "engine/errors.hpp"
#include "engine/estimation/student_t.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace bris {

namespace {

constexpr std::size_t strains_used = 10, per_sensor = LibraryTest::per_sensor;
constexpr std::array window_ends{0.02, 0.04, 1.0}; // axial strain
constexpr std::size_t first_tilt = 3, tilts = 2;   // of the numbers of a sensor rock

/// ln q, where q is at least 1 % of the confining pressure: a specimen that slips loses its q for a
/// moment.
double log_q(double q, double pressure) { return std::log(std::max(q, 0.01 * pressure)); }

/// Indices of the strains at which curves are observed: up to ten, equally spaced, the last one at
/// the last strain of the library that does not exceed `strain`.
std::vector<std::size_t> observed_strains(const LibraryAxis& axis, double strain) {
    const auto steps = static_cast<std::size_t>(std::floor(strain / axis.step * (1 + 1e-9)));
    require(steps >= 1 && steps <= axis.count,
            fmt::format("--learning-strain: expected {:g} to {:g}, the strains of the library, "
                        "found {:g}",
                        axis.step, axis.strain(axis.count - 1), strain));
    const std::size_t used = std::min(steps, strains_used);
    std::vector<std::size_t> indices;
    for (std::size_t k = 1; k <= used; ++k) indices.push_back((k * steps + used / 2) / used - 1);
    return indices;
}

std::size_t observed_coarse(const LibraryAxis& axis, double strain) {
    const auto steps = static_cast<std::size_t>(std::floor(strain / axis.step * (1 + 1e-9)));
    require(steps >= axis.every,
            fmt::format("--learning-strain: expected at least {:g}, the first strain at which the "
                        "library has sensor rocks, found {:g}",
                        axis.coarse_strain(0), strain));
    return steps / axis.every - 1;
}

/// Calls visit(numbers of the block) for each observed block of a specimen.
template <class Visit>
void visit_blocks(const SpecimenLibrary& library, const LibrarySpecimen& s, std::size_t pressure,
                  const LibraryObservations& o, const Visit& visit) {
    const LibraryTest& test = s.tests.at(pressure);
    std::vector<double> block;
    const auto next = [&] {
        visit(block);
        block.clear();
    };
    const auto strains = observed_strains(library.axis, o.strain);
    if (o.force) {
        for (const std::size_t k : strains)
            block.push_back(log_q(double{test.q.at(k)}, library.pressures[pressure]));
        next();
    }
    if (o.volume) {
        for (const std::size_t k : strains) block.push_back(double{test.volume.at(k)});
        next();
    }
    if (o.rings) {
        for (std::size_t r = 0; r < library.rings; ++r)
            block.push_back(double{test.rings.at(strains.back() * library.rings + r)});
        next();
    }
    if (o.tracked || o.tilt) {
        const std::size_t from =
            observed_coarse(library.axis, o.strain) * library.sensors * per_sensor;
        for (std::size_t k = 0; k < library.sensors * per_sensor; ++k) {
            const std::size_t part = k % per_sensor;
            const bool is_tilt = part >= first_tilt && part < first_tilt + tilts;
            if (o.tracked || is_tilt) block.push_back(double{test.sensors.at(from + k)});
        }
        next();
    }
    if (o.porosity) {
        block.push_back(s.core_porosity);
        next();
    }
}

Vector as_vector(const std::vector<double>& numbers) {
    return Eigen::Map<const Vector>(numbers.data(), static_cast<Eigen::Index>(numbers.size()));
}

} // namespace

LibraryTargets::LibraryTargets(const SpecimenLibrary& library, std::vector<std::size_t> pressures,
                               bool motion)
    : library_(library), pressures_(std::move(pressures)) {
    const auto fine = static_cast<Eigen::Index>(library.axis.count),
               coarse = motion ? static_cast<Eigen::Index>(library.axis.coarse_count()) : 0;
    lengths_ = {fine, fine, fine, fine, coarse, coarse};
    widths_ = {1,
               1,
               1,
               static_cast<Eigen::Index>(library.rings),
               static_cast<Eigen::Index>(library.sensors * per_sensor),
               static_cast<Eigen::Index>(2 * FieldCells::count)};
    for (std::size_t b = 0; b < widths_.size(); ++b) per_pressure_ += widths_[b] * lengths_[b];
    count_ = static_cast<Eigen::Index>(pressures_.size()) * per_pressure_;
}

Eigen::Index LibraryTargets::column(std::size_t pressure, Block block) const {
    Eigen::Index first = static_cast<Eigen::Index>(pressure) * per_pressure_;
    for (std::size_t b = 0; b < static_cast<std::size_t>(block); ++b)
        first += widths_[b] * lengths_[b];
    return first;
}

Vector LibraryTargets::values(const LibrarySpecimen& s) const {
    std::vector<double> numbers;
    const auto add = [&](const std::vector<float>& curve) {
        numbers.insert(numbers.end(), curve.begin(), curve.end());
    };
    for (const std::size_t p : pressures_) {
        const LibraryTest& test = s.tests.at(p);
        for (const auto* curve : {&test.q, &test.smoothed_q})
            for (const float x : *curve) numbers.push_back(log_q(double{x}, library_.pressures[p]));
        add(test.volume);
        add(test.rings);
        if (lengths_[sensors] > 0) add(test.sensors);
        if (lengths_[field] > 0) add(test.field);
    }
    return as_vector(numbers);
}

std::vector<TargetGroup> LibraryTargets::groups() const {
    std::vector<TargetGroup> groups;
    Eigen::Index next = 0;
    const auto add = [&](Eigen::Index count) {
        if (count > 0) groups.push_back({next, count});
        next += count;
    };
    for (std::size_t p = 0; p < pressures_.size(); ++p)
        for (std::size_t b = 0; b < widths_.size(); ++b) {
            Eigen::Index strain = 0;
            for (const double end : window_ends) {
                const Eigen::Index from = strain;
                const auto strain_at = [&](Eigen::Index k) {
                    const auto index = static_cast<std::size_t>(k);
                    return b >= sensors ? library_.axis.coarse_strain(index)
                                        : library_.axis.strain(index);
                };
                while (strain < lengths_[b] && strain_at(strain) < end * (1 + 1e-9)) ++strain;
                add((strain - from) * widths_[b]);
            }
        }
    return groups;
}

Vector features_of(const SpecimenLibrary& library, const LibrarySpecimen& specimen,
                   std::size_t pressure, const LibraryObservations& observed) {
    std::vector<double> features;
    visit_blocks(library, specimen, pressure, observed, [&](const std::vector<double>& block) {
        features.insert(features.end(), block.begin(), block.end());
    });
    return as_vector(features);
}

Vector weights_of(const SpecimenLibrary& library, const LibraryObservations& observed) {
    std::vector<double> weights;
    visit_blocks(library, library.specimens.front(), 0, observed,
                 [&](const std::vector<double>& block) {
                     weights.insert(weights.end(), block.size(),
                                    1 / std::sqrt(static_cast<double>(block.size())));
                 });
    return as_vector(weights);
}

Vector parameter_features_of(const SpecimenLibrary& library, const LibrarySpecimen& specimen,
                             std::size_t pressure, const LibraryObservations& o) {
    if (!o.force && !o.volume) return features_of(library, specimen, pressure, o);
    const LibraryTest& test = specimen.tests.at(pressure);
    const std::size_t last = observed_strains(library.axis, o.strain).back();
    std::vector<double> features;
    if (o.force) {
        double mean = 0;
        for (std::size_t k = 0; k <= last; ++k)
            mean += double{test.q.at(k)} / static_cast<double>(last + 1);
        features.push_back(log_q(mean, library.pressures[pressure]));
    }
    if (o.volume) features.push_back(double{test.volume.at(last)});
    if (o.porosity) features.push_back(specimen.core_porosity);
    return as_vector(features);
}

namespace {

void check_regression(const SpecimenLibrary& library, const LibraryObservations& observed) {
    constexpr std::size_t fewest = 8;
    require(observed.any(), "--use-force, --use-volume, ...: expected a measurement to assimilate, "
                            "found none");
    const std::size_t n = library.specimens.size();
    require(n >= fewest,
            fmt::format("specimen library: expected at least {} specimens, found {}", fewest, n));
}

/// A row of numbers for each specimen.
template <class Numbers>
Matrix rows_of(const SpecimenLibrary& library, const Numbers& numbers) {
    Matrix rows;
    for (std::size_t k = 0; k < library.specimens.size(); ++k) {
        const Vector row = numbers(library.specimens[k]);
        if (k == 0) rows.resize(static_cast<Eigen::Index>(library.specimens.size()), row.size());
        rows.row(static_cast<Eigen::Index>(k)) = row.transpose();
    }
    return rows;
}

} // namespace

HybridRegression regression_of(const SpecimenLibrary& library, const LibraryObservations& observed,
                               std::size_t measured_at, const LibraryTargets& targets) {
    check_regression(library, observed);
    return {rows_of(library,
                    [&](const LibrarySpecimen& s) {
                        return features_of(library, s, measured_at, observed);
                    }),
            weights_of(library, observed),
            rows_of(library, [&](const LibrarySpecimen& s) { return targets.values(s); }),
            targets.groups()};
}

HybridRegression parameter_regression_of(const SpecimenLibrary& library,
                                         const LibraryObservations& observed,
                                         std::size_t measured_at) {
    check_regression(library, observed);
    const Matrix features = rows_of(library, [&](const LibrarySpecimen& s) {
        return parameter_features_of(library, s, measured_at, observed);
    });
    const bool single = observed.force || observed.volume; // one number of each block
    const Vector weights = single ? Vector::Ones(features.cols()) : weights_of(library, observed);
    return {features,
            weights,
            rows_of(library,
                    [](const LibrarySpecimen& s) {
                        return Vector(Eigen::Vector3d(std::log(s.rocks.friction),
                                                      std::log(s.rocks.stiffness),
                                                      s.core_porosity));
                    }),
            {{ParameterColumn::ln_friction, 1},
             {ParameterColumn::ln_stiffness, 1},
             {ParameterColumn::porosity, 1}}};
}

LibraryPredictor::LibraryPredictor(const SpecimenLibrary& library,
                                   const LibraryObservations& observed, std::size_t measured_at,
                                   std::size_t predicted_at, bool motion)
    : library_(library), observed_(observed), measured_at_(measured_at),
      targets_(library, {predicted_at}, motion),
      regression_(regression_of(library, observed, measured_at, targets_)),
      parameters_(parameter_regression_of(library, observed, measured_at)) {}

LibraryPrediction LibraryPredictor::predict(const LibrarySpecimen& measured) const {
    return described(
        regression_.predict(features_of(library_, measured, measured_at_, observed_)),
        parameters_.predict(parameter_features_of(library_, measured, measured_at_, observed_)));
}

LibraryPrediction LibraryPredictor::prior() const {
    return described(regression_.prior(), parameters_.prior());
}

std::vector<double> LibraryPredictor::weights(const LibrarySpecimen& measured) const {
    const Vector w =
        regression_.sample_weights(features_of(library_, measured, measured_at_, observed_));
    return {w.begin(), w.end()};
}

LibraryPrediction
LibraryPredictor::described(const HybridRegression::Prediction& curves,
                            const HybridRegression::Prediction& parameters) const {
    const double t = student_t_quantile(0.95, regression_.freedom());
    const auto number = [&](const HybridRegression::Prediction& p, Eigen::Index k,
                            bool logarithmic) {
        const auto natural = [&](double x) { return logarithmic ? std::exp(x) : x; };
        return NumberWithBand{natural(p.mean[k]), natural(p.mean[k] - t * p.deviation[k]),
                              natural(p.mean[k] + t * p.deviation[k])};
    };
    const auto add = [&](TestCurves& to, const Quantity& quantity, LibraryTargets::Block block,
                         bool logarithmic = false) {
        const Eigen::Index width = targets_.width(block);
        for (Eigen::Index w = 0; w < width; ++w) {
            TestCurves::Column& c = to.column(quantity, static_cast<std::size_t>(w));
            c.values.clear();
            for (Eigen::Index k = 0; k < targets_.length(block); ++k) {
                const NumberWithBand n =
                    number(curves, targets_.column(0, block) + k * width + w, logarithmic);
                c.values.push_back(n.value);
                c.low.push_back(n.low);
                c.high.push_back(n.high);
            }
        }
    };
    using Block = LibraryTargets::Block;
    const LibraryAxis& axis = library_.axis;
    LibraryPrediction d;
    for (std::size_t k = 0; k < axis.count; ++k)
        d.curves.add_row()[quantity::axial_strain] = axis.strain(k);
    add(d.curves, quantity::deviatoric_stress, Block::q, true);
    add(d.curves, quantity::smoothed_q, Block::smoothed_q, true);
    add(d.curves, quantity::volumetric_strain, Block::volume);
    add(d.curves, quantity::radial_strain, Block::rings);
    for (Eigen::Index k = 0; k < targets_.length(Block::sensors); ++k)
        d.motion.add_row()[quantity::axial_strain] =
            axis.coarse_strain(static_cast<std::size_t>(k));
    add(d.motion, quantity::sensor_motion, Block::sensors);
    add(d.motion, quantity::displacement_field, Block::field);
    d.friction = number(parameters, ParameterColumn::ln_friction, true);
    d.stiffness = number(parameters, ParameterColumn::ln_stiffness, true);
    d.porosity = number(parameters, ParameterColumn::porosity, false);
    d.distance = std::max(curves.distance, parameters.distance);
    return d;
}

} // namespace bris
