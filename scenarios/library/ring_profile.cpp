#include "scenarios/library/ring_profile.hpp"

#include "engine/errors.hpp"
#include "engine/estimation/student_t.hpp"
#include "engine/io/whole_file.hpp"
#include "scenarios/triaxial/triaxial_results.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <utility>

namespace bris {

namespace {

constexpr std::size_t per_sensor = LibraryTest::per_sensor;
constexpr std::array<std::size_t, 2> displacements{0, 2}, tilts{3, 4};

double root_mean_square(const Vector& v) {
    return std::sqrt(v.squaredNorm() / static_cast<double>(v.size()));
}

/// Mean of a number, or of numbers, of the tests at one pressure.
template <class Number>
auto mean_over(const SpecimenLibrary& library, std::size_t pressure, const Number& number) {
    auto sum = number(library.specimens.at(0).tests.at(pressure));
    for (std::size_t k = 1; k < library.specimens.size(); ++k)
        sum += number(library.specimens[k].tests.at(pressure));
    return sum /= static_cast<double>(library.specimens.size());
}

constexpr std::array variants{std::pair{RingSensors::none, "volume"},
                              std::pair{RingSensors::tilt, "volume_and_tilt"},
                              std::pair{RingSensors::tracked, "volume_and_tracked"}};

} // namespace

RingProfile::RingProfile(const SpecimenLibrary& library, std::size_t pressure, std::size_t coarse,
                         RingSensors sensors)
    : strain_(library.axis.coarse_strain(coarse)), fine_(library.axis.every * (coarse + 1) - 1),
      coarse_(coarse), rings_(library.rings), sensors_count_(library.sensors), sensors_(sensors),
      mean_(mean_over(library, pressure, [&](const LibraryTest& t) { return rings(t); })),
      mean_radial_(mean_over(library, pressure,
                             [&](const LibraryTest& t) { return mean_radial_strain(t); })),
      regression_(made(library, pressure)) {}

// The radial strain of a cylinder that has the volumetric and axial strains of the specimen.
double RingProfile::mean_radial_strain(const LibraryTest& test) const {
    return std::sqrt((1 - double{test.volume.at(fine_)}) / (1 - strain_)) - 1;
}

Vector RingProfile::rings(const LibraryTest& test) const {
    Vector profile(static_cast<Eigen::Index>(rings_));
    for (std::size_t r = 0; r < rings_; ++r)
        profile[static_cast<Eigen::Index>(r)] = double{test.rings.at(fine_ * rings_ + r)};
    return profile;
}

Vector RingProfile::features(const LibraryTest& test) const {
    std::vector<double> numbers{double{test.volume.at(fine_)}};
    if (sensors_ != RingSensors::none)
        for (std::size_t s = 0; s < sensors_count_; ++s)
            for (const std::size_t part : sensors_ == RingSensors::tilt ? tilts : displacements)
                numbers.push_back(
                    double{test.sensors.at((coarse_ * sensors_count_ + s) * per_sensor + part)});
    return Eigen::Map<const Vector>(numbers.data(), static_cast<Eigen::Index>(numbers.size()));
}

LeaveOneOutRegression RingProfile::made(const SpecimenLibrary& library,
                                        std::size_t pressure) const {
    const auto n = static_cast<Eigen::Index>(library.specimens.size());
    Matrix samples, departures(n, mean_.size());
    for (Eigen::Index k = 0; k < n; ++k) {
        const LibraryTest& test = library.specimens[static_cast<std::size_t>(k)].tests[pressure];
        const Vector row = features(test);
        if (k == 0) samples.resize(n, row.size());
        samples.row(k) = row.transpose();
        departures.row(k) = (rings(test) - scaled_mean(test)).transpose();
    }
    // the numbers of the sensor rocks together weigh as much as the volume
    Vector weights = Vector::Ones(samples.cols());
    if (weights.size() > 1)
        weights.tail(weights.size() - 1)
            .setConstant(1 / std::sqrt(static_cast<double>(weights.size() - 1)));
    return {samples, weights, departures, {{0, mean_.size()}}};
}

Vector RingProfile::scaled_mean(const LibraryTest& measured) const {
    return mean_ * (mean_radial_strain(measured) / mean_radial_);
}

RingProfile::Estimate RingProfile::estimate(const LibraryTest& measured) const {
    const LeaveOneOutRegression::Prediction p = regression_.predict(features(measured));
    return {scaled_mean(measured) + p.mean, p.deviation};
}

double RingProfile::correlation_of_neighbours() const {
    const Matrix& r = regression_.residuals();
    double sum = 0;
    for (Eigen::Index k = 0; k + 1 < r.cols(); ++k)
        sum += r.col(k).dot(r.col(k + 1)) / (r.col(k).norm() * r.col(k + 1).norm());
    return sum / static_cast<double>(r.cols() - 1);
}

namespace {

RingScore score_of(const SpecimenLibrary& library, std::size_t pressure, std::size_t coarse,
                   RingSensors sensors) {
    RingScore score;
    score.pressure = library.pressures[pressure];
    score.strain = library.axis.coarse_strain(coarse);
    std::vector<double> over_single, over_scaled;
    const std::size_t fine = library.axis.every * (coarse + 1) - 1;
    const auto rings_of = [&](const LibrarySpecimen& s) {
        return Eigen::Map<const Eigen::VectorXf>(s.tests[pressure].rings.data() +
                                                     fine * library.rings,
                                                 static_cast<Eigen::Index>(library.rings))
            .cast<double>()
            .eval();
    };
    for (std::size_t k = 0; k < library.specimens.size(); ++k) {
        SpecimenLibrary others = library;
        others.specimens.erase(others.specimens.begin() + static_cast<std::ptrdiff_t>(k));
        const RingProfile profile(others, pressure, coarse, sensors);
        const LibraryTest& measured = library.specimens[k].tests[pressure];
        const Vector truth = rings_of(library.specimens[k]);
        const RingProfile::Estimate e = profile.estimate(measured);
        double single = 0;
        for (const LibrarySpecimen& other : others.specimens)
            single += root_mean_square(rings_of(other) - truth) /
                      static_cast<double>(others.specimens.size());
        const double error = root_mean_square(e.mean - truth);
        over_single.push_back(error / single);
        over_scaled.push_back(error / root_mean_square(profile.scaled_mean(measured) - truth));
        const double t = student_t_quantile(0.95, profile.freedom());
        const auto within = ((e.mean - truth).cwiseAbs().array() < t * e.deviation.array()).count();
        score.inside += static_cast<double>(within) /
                        static_cast<double>(library.rings * library.specimens.size());
        score.neighbours +=
            profile.correlation_of_neighbours() / static_cast<double>(library.specimens.size());
    }
    score.over_single = geometric_mean(over_single, 1);
    score.over_scaled_mean = geometric_mean(over_scaled, 1);
    return score;
}

} // namespace

std::vector<RingScore> score_rings(const SpecimenLibrary& library) {
    std::vector<RingScore> scores;
    const std::size_t last = library.axis.coarse_count();
    for (std::size_t p = 0; p < library.pressures.size(); ++p)
        for (const std::size_t coarse : {last / 2 - 1, last - 1})
            for (const auto& [sensors, name] : variants) {
                if (sensors != RingSensors::none && library.sensors == 0) continue;
                scores.push_back(score_of(library, p, coarse, sensors));
                scores.back().variant = name;
            }
    return scores;
}

void write_ring_scores(const std::filesystem::path& csv, const std::vector<RingScore>& scores) {
    std::string text = "variant,pressure_kPa,strain_percent,over_single_run,low,high,"
                       "over_scaled_mean,low,high,inside_band,correlation_of_neighbours\n";
    for (const RingScore& s : scores)
        text +=
            fmt::format("{},{:g},{:g},{:.4g},{:.4g},{:.4g},{:.4g},{:.4g},{:.4g},{:.4g},{:.4g}\n",
                        s.variant, s.pressure / 1e3, 100 * s.strain, s.over_single.mean,
                        s.over_single.low, s.over_single.high, s.over_scaled_mean.mean,
                        s.over_scaled_mean.low, s.over_scaled_mean.high, s.inside, s.neighbours);
    write_whole(csv, text);
}

} // namespace bris
