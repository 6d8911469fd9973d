#include "scenarios/library/sensor_predictive.hpp"

#include "engine/errors.hpp"
#include "engine/io/whole_file.hpp"
#include "scenarios/specimens/sensor_rocks.hpp"

#include <Eigen/LU>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace bris {

double SensorPredictive::Fit::distance(const Motion& motion) const {
    const Vec3 off = motion.displacement - mean(motion.volume);
    // the prediction is uncertain too, more so far from the mean volume
    const double more = 1 + 1 / count + std::pow(motion.volume - mean_volume, 2) / spread;
    return std::sqrt(off.dot(inverse * off) / more);
}

SensorPredictive::Fit SensorPredictive::fit(const std::vector<Motion>& motions,
                                            std::size_t without) {
    Fit f;
    const auto for_each = [&](auto&& visit) {
        for (std::size_t k = 0; k < motions.size(); ++k)
            if (k != without) visit(motions[k]);
    };
    f.count = static_cast<double>(motions.size() - (without < motions.size() ? 1 : 0));
    for_each([&](const Motion& m) {
        f.mean_volume += m.volume / f.count;
        f.at_mean += m.displacement / f.count;
    });
    for_each([&](const Motion& m) { f.spread += std::pow(m.volume - f.mean_volume, 2); });
    for_each([&](const Motion& m) {
        f.slope += (m.volume - f.mean_volume) / f.spread * (m.displacement - f.at_mean);
    });
    Mat3 covariance = Mat3::Zero();
    for_each([&](const Motion& m) {
        const Vec3 off = m.displacement - f.mean(m.volume);
        covariance += off * off.transpose() / (f.count - 2);
    });
    f.inverse = covariance.inverse();
    f.deviation = covariance.diagonal().cwiseSqrt();
    return f;
}

SensorPredictive::SensorPredictive(const SpecimenLibrary& library, std::size_t pressure,
                                   std::size_t coarse, std::size_t without) {
    for (std::size_t s = 0; s < library.sensors; ++s) {
        std::vector<Motion> motions;
        for (std::size_t k = 0; k < library.specimens.size(); ++k)
            if (k != without)
                motions.push_back(
                    motion_in(library, library.specimens[k].tests.at(pressure), coarse, s));
        require(motions.size() >= fewest,
                fmt::format("specimen library: expected at least {} specimens, found {}", fewest,
                            motions.size()));
        fits_.push_back(fit(motions, none));
        for (std::size_t k = 0; k < motions.size(); ++k)
            largest_ = std::max(largest_, fit(motions, k).distance(motions[k]));
    }
}

SensorPredictive::Motion SensorPredictive::motion_in(const SpecimenLibrary& library,
                                                     const LibraryTest& test, std::size_t coarse,
                                                     std::size_t sensor) {
    const float* u =
        &test.sensors.at((coarse * library.sensors + sensor) * LibraryTest::per_sensor);
    return {double{test.volume.at(library.axis.every * (coarse + 1) - 1)},
            {double{u[0]}, double{u[1]}, double{u[2]}}};
}

namespace {

using Motion = SensorPredictive::Motion;

/// Angle of each of the usual sensor rocks about the axis, and whether it stands in the centre.
struct Place {
    double angle = 0;
    bool central = false;
};
std::vector<Place> usual_places(std::size_t sensors) {
    std::vector<Place> places;
    for (const SmartRockPose& p :
         smart_rock_poses({.radius = 1, .height = 1, .bounding_radius = 0.2}, 1, sensors))
        places.push_back({std::atan2(p.position.y(), p.position.x()),
                          std::hypot(p.position.x(), p.position.y()) < 0.1});
    return places;
}

Vec3 turned(const Vec3& v, double angle) { return Eigen::AngleAxisd(angle, Vec3::UnitZ()) * v; }

/// The motions of all sensor rocks of a test at one strain; `before`: 0.5 % of strain earlier.
struct TestMotions {
    std::vector<Motion> now, before;
};

/// A recording with a fault: displacement outward, sideways and upward as the test would have it.
using Fault = Vec3 (*)(const TestMotions&, std::size_t sensor, const std::vector<Place>&);

template <class Change>
Vec3 in_world(const TestMotions& test, std::size_t s, const std::vector<Place>& places,
              Change&& change) {
    return turned(change(turned(test.now[s].displacement, places[s].angle)), -places[s].angle);
}

const std::vector<std::pair<const char*, Fault>>& faults() {
    using Test = const TestMotions&;
    using Places = const std::vector<Place>&;
    static const std::vector<std::pair<const char*, Fault>> list{
        {"none", [](Test t, std::size_t s, Places) { return t.now[s].displacement; }},
        {"x mirrored",
         [](Test t, std::size_t s, Places p) {
             return in_world(t, s, p, [](const Vec3& u) { return Vec3(-u.x(), u.y(), u.z()); });
         }},
        {"x and y exchanged",
         [](Test t, std::size_t s, Places p) {
             return in_world(t, s, p, [](const Vec3& u) { return Vec3(u.y(), u.x(), u.z()); });
         }},
        {"z mirrored",
         [](Test t, std::size_t s, Places p) {
             return in_world(t, s, p, [](const Vec3& u) { return Vec3(u.x(), u.y(), -u.z()); });
         }},
        {"of the next sensor",
         [](Test t, std::size_t s, Places p) {
             const std::size_t next = (s + 1) % p.size();
             return turned(turned(t.now[next].displacement, p[next].angle), -p[s].angle);
         }},
        {"times 1000",
         [](Test t, std::size_t s, Places) -> Vec3 { return 1000 * t.now[s].displacement; }},
        {"times 0.01",
         [](Test t, std::size_t s, Places) -> Vec3 { return 0.01 * t.now[s].displacement; }},
        {"late by 0.5 % of strain",
         [](Test t, std::size_t s, Places) { return t.before[s].displacement; }}};
    return list;
}

/// Scores all faults at one pressure and strain.
std::vector<SuspicionScore> scores_at(const SpecimenLibrary& library, std::size_t pressure,
                                      std::size_t coarse) {
    const std::vector<Place> places = usual_places(library.sensors);
    std::vector<SuspicionScore> scores;
    for (const auto& [name, fault] : faults())
        scores.push_back({name, library.pressures[pressure], library.axis.coarse_strain(coarse)});
    const auto central = static_cast<double>(std::ranges::count_if(places, &Place::central)),
               n = static_cast<double>(library.specimens.size());
    for (std::size_t k = 0; k < library.specimens.size(); ++k) {
        const LibraryTest& test = library.specimens[k].tests[pressure];
        const SensorPredictive predictive(library, pressure, coarse, k);
        TestMotions motions;
        for (std::size_t s = 0; s < library.sensors; ++s) {
            motions.now.push_back(SensorPredictive::motion_in(library, test, coarse, s));
            motions.before.push_back(SensorPredictive::motion_in(library, test, coarse - 1, s));
        }
        for (std::size_t f = 0; f < scores.size(); ++f) {
            bool any = false;
            for (std::size_t s = 0; s < library.sensors; ++s) {
                const Vec3 u = faults()[f].second(motions, s, places);
                if (predictive.distance(s, {motions.now[s].volume, u}) <= 1) continue;
                any = true;
                if (places[s].central)
                    scores[f].centre += 1 / (n * central);
                else
                    scores[f].beside += 1 / (n * (static_cast<double>(places.size()) - central));
            }
            scores[f].tests += any ? 1 / n : 0;
        }
    }
    return scores;
}

} // namespace

std::vector<SuspicionScore> score_suspicions(const SpecimenLibrary& library) {
    constexpr std::size_t usual = 10;
    if (library.sensors != usual || library.specimens.size() <= SensorPredictive::fewest) return {};
    std::vector<SuspicionScore> all;
    const std::size_t last = library.axis.coarse_count();
    for (std::size_t p = 0; p < library.pressures.size(); ++p)
        for (const std::size_t coarse : {last / 2 - 1, last - 1})
            for (SuspicionScore& s : scores_at(library, p, coarse)) all.push_back(std::move(s));
    return all;
}

void write_suspicions(const std::filesystem::path& csv, const std::vector<SuspicionScore>& scores) {
    std::string text =
        "fault,pressure_kPa,strain_percent,beside_the_membrane,in_the_centre,tests\n";
    for (const SuspicionScore& s : scores)
        text += fmt::format("{},{:g},{:g},{:.4g},{:.4g},{:.4g}\n", s.fault, s.pressure / 1e3,
                            100 * s.strain, s.beside, s.centre, s.tests);
    write_whole(csv, text);
}

} // namespace bris
