#include "scenarios/sensors/quality_control.hpp"

#include "engine/estimation/linear_fit.hpp"
#include "engine/io/csv.hpp"
#include "scenarios/sensors/channels.hpp"
#include "scenarios/sensors/inspection.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace bris {

namespace {

constexpr double degree = pi / 180;

class QualityControl {
public:
    QualityControl(const Recording& recording, const Vec3& gravity,
                   const QualityControlLimits& limits, std::vector<Finding>& findings)
        : at_{recording, limits, findings}, r_(recording), gravity_(gravity), limits_(limits) {}

    void run() {
        check_flags(at_);
        if (!r_.unused.empty()) at_.findings.push_back(note_on_unused(r_.info.id, r_.unused));
        if (r_.size() < 2)
            return refuse("length",
                          fmt::format("expected at least two samples, found {}", r_.size()));
        if (std::ranges::none_of(all_channels, [&](const Channel& channel) {
                return channel.size() > 1 && channel.samples(r_) > 0;
            }))
            return refuse("channels", fmt::format("expected at least one of {}, found none",
                                                  names_of_vectors(" and ")));
        if (!check_numbers() || !check_times() || !has_possible_strain(at_))
            return; // further checks would be meaningless
        at_.find_rest();
        check_clock();
        check_count(at_);
        check_device(at_);
        check_field(at_);
        check_displacement(at_);
        check_attitude(at_, gravity_);
        if (!r_.force.empty()) {
            check_range("force", r_.force, r_.info.force_range, "m/s2");
            check_noise("force", r_.force, r_.info.force_noise, "m/s2/sqrt(Hz)");
            check_gravity();
        }
        if (r_.rate.empty()) return;
        check_range("rate", r_.rate, r_.info.rate_range, "rad/s");
        check_noise("rate", r_.rate, r_.info.rate_noise, "rad/s/sqrt(Hz)");
        if (at_.still > 0) check_rates();
    }

private:
    void note(std::string check, std::string text) { at_.note(std::move(check), std::move(text)); }
    void refuse(std::string check, std::string text) {
        at_.refuse(std::move(check), std::move(text));
    }
    Vec3 mean_at_rest(const std::vector<Vec3>& values) const {
        Vec3 sum = Vec3::Zero();
        for (std::size_t k = 0; k < at_.rest; ++k) sum += values[k];
        return sum / static_cast<double>(at_.rest);
    }

    bool check_numbers() {
        const auto first = [&](std::string_view columns) {
            const auto entry = r_.first_without.find(std::string(columns));
            return entry == r_.first_without.end()
                       ? ""
                       : fmt::format("; {}: the first at {}", columns, entry->second);
        };
        auto count = static_cast<std::size_t>(
            std::ranges::count_if(r_.time, [](double t) { return !std::isfinite(t); }));
        std::string where = first("t");
        for (const Channel& channel : all_channels) {
            const std::size_t missing = channel.without_number(r_);
            if (!channel.is(Channel::sparse)) {
                count += missing;
                where += first(channel.names.columns);
            } else if (missing > 0) { // a sample remains useful
                note("numbers", fmt::format("{} of {} samples have no number{}", missing,
                                            channel.samples(r_), first(channel.names.columns)));
            }
        }
        if (count > 0)
            refuse("numbers",
                   fmt::format("expected finite numbers, found {} that are not{}", count, where));
        return count == 0;
    }

    bool check_times() {
        const double nominal = 1 / r_.info.sampling_rate;
        std::size_t backwards = 0, twice = 0;
        std::vector<double> gaps;
        double widest = 0, squares = 0;
        for (std::size_t k = 1; k < r_.size(); ++k) {
            const double gap = r_.time[k] - r_.time[k - 1];
            backwards += static_cast<std::size_t>(
                gap < 0 || (!r_.sequence.empty() && r_.sequence[k] < r_.sequence[k - 1]));
            twice += static_cast<std::size_t>(
                gap == 0 || (!r_.sequence.empty() && r_.sequence[k] == r_.sequence[k - 1]));
            gaps.push_back(gap);
            widest = std::max(widest, gap);
            const double jitter = gap - nominal * std::max(1.0, std::round(gap / nominal));
            squares += jitter * jitter;
        }
        const auto steps = static_cast<double>(r_.size() - 1);
        if (backwards > 0)
            refuse("order",
                   fmt::format("expected increasing times and counts, found {} that decrease",
                               backwards));
        if (twice > 0)
            refuse("twice", fmt::format("expected each sample once, found {} repeated", twice));
        if (backwards + twice > 0) return false;
        if (const double usual = median(std::move(gaps)); usual < 0.5 * nominal) {
            refuse("rate", fmt::format("expected {:.4g} samples a second (sampling_rate), found "
                                       "{:.4g} by the times: is t in another unit?",
                                       1 / nominal, 1 / usual));
            return false;
        }
        const double lost =
            1 - steps / std::max(steps, (r_.time.back() - r_.time.front()) / nominal);
        if (lost > limits_.lost)
            refuse("gaps",
                   fmt::format("expected at most {:.0f} % of the samples missing, found {:.0f} %",
                               100 * limits_.lost, 100 * lost));
        else if (widest > 1.5 * nominal)
            note("gaps",
                 fmt::format("{:.2f} % of the samples are missing, the longest gap is {:.3g} s",
                             100 * lost, widest));
        const double jitter = std::sqrt(squares / steps);
        if (jitter > 0.1 * nominal)
            note("jitter",
                 fmt::format("the sampling times scatter by {:.2g} s, {:.0f} % of the interval",
                             jitter, 100 * jitter / nominal));
        return true;
    }

    void check_clock() {
        if (r_.sequence.size() < 10) return; // too few to distinguish drift from jitter
        std::vector<double> due;
        for (const std::uint64_t n : r_.sequence)
            due.push_back(static_cast<double>(n - r_.sequence.front()) / r_.info.sampling_rate);
        const double drift = fit_line(due, r_.time, due.front(), due.back()).slope - 1;
        const auto text = fmt::format(
            "the clock runs fast against the sample counter by a fraction of {:.3g}", drift);
        if (std::abs(drift) > limits_.clock_drift)
            refuse("clock", text + fmt::format(", expected at most {:.1g}", limits_.clock_drift));
        else if (std::abs(drift) > 1e-5)
            note("clock", text);
    }

    void check_range(const char* what, const std::vector<Vec3>& values, double range,
                     const char* unit) {
        const auto full = std::ranges::count_if(
            values, [&](const Vec3& v) { return v.cwiseAbs().maxCoeff() >= 0.999 * range; });
        const double share = static_cast<double>(full) / static_cast<double>(values.size());
        const auto text =
            fmt::format("{} of {} samples of {} are at the end of the range, {:.4g} {}", full,
                        values.size(), what, range, unit);
        if (share > limits_.saturated)
            refuse("saturation", text);
        else if (full > 0)
            note("saturation", text);
    }

    void check_noise(const char* what, const std::vector<Vec3>& values, double density,
                     const char* unit) {
        if (density <= 0 || is_stuck(at_, what, values, density) ||
            has_stuck_axis(at_, what, values))
            return;
        if (at_.rest < 20)
            return note("noise",
                        fmt::format("{}: too few samples at rest (--rest) to estimate it, found {}",
                                    what, at_.rest));
        const Vec3 mean = mean_at_rest(values);
        double squares = 0;
        for (std::size_t k = 0; k < at_.rest; ++k) squares += (values[k] - mean).squaredNorm();
        const double found = std::sqrt(squares / (3 * static_cast<double>(at_.rest - 1)) /
                                       r_.info.sampling_rate),
                     ratio = found / density;
        if (ratio > limits_.noise_ratio || ratio < 1 / limits_.noise_ratio)
            note("noise", fmt::format("{} at rest: declared {:.3g} {}, found {:.3g}", what, density,
                                      unit, found));
    }

    void check_gravity() {
        const Vec3 mean_force = mean_at_rest(r_.force);
        const double g = gravity_.norm(), size = mean_force.norm();
        const double limit = limits_.gravity + 3 * r_.info.force_bias / g;
        if (std::abs(size / g - 1) > limit) {
            const bool in_g = std::abs(size - 1) < 2 * limits_.gravity,
                       twice = std::abs(size / (g * g) - 1) < 2 * limits_.gravity;
            return refuse(
                "gravity",
                fmt::format("at rest: expected {:.3f} m/s2 within {:.0f} %, found {:.3f}{}", g,
                            100 * limit, size,
                            in_g    ? ": the recording seems to be in g"
                            : twice ? ": the recording seems to be in m/s2, not in g"
                                    : ""));
        }
        const double deviation =
            std::acos(std::clamp((r_.info.attitude() * mean_force).normalized().dot(-gravity_ / g),
                                 -1.0, 1.0)) /
            degree;
        if (deviation > limits_.frame + 3 * r_.info.attitude_deviation)
            refuse("frame",
                   fmt::format("at rest: expected the force, rotated by the attitude at "
                               "the start, to point upwards, found it {:.0f} degrees off{}",
                               deviation,
                               deviation > 165 ? ": the sign seems to be reversed" : ""));
    }

    /// A rock at rest rotates with the earth; anything else in its rates is bias and noise.
    void check_rates() {
        constexpr double earth = 7.3e-5; // rad/s
        const double found = at_.median_before_test(r_.rate).norm();
        const double expected =
            2 * earth +
            8 * std::hypot(r_.info.rate_bias,
                           r_.info.rate_noise *
                               std::sqrt(r_.info.sampling_rate / static_cast<double>(at_.still)));
        if (found > expected)
            refuse("rate",
                   fmt::format("at rest: expected at most {:.2g} rad/s, found {:.2g}{}", expected,
                               found, found * degree < expected ? ": they may be in deg/s" : ""));
    }

    Inspection at_;
    const Recording& r_;
    Vec3 gravity_;
    const QualityControlLimits& limits_;
};

/// Correlation coefficient of two series of vectors over their common length.
double correlation(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
    const std::size_t n = std::min(a.size(), b.size());
    Vec3 mean_a = Vec3::Zero(), mean_b = Vec3::Zero();
    for (std::size_t k = 0; k < n; ++k) {
        mean_a += a[k] / static_cast<double>(n);
        mean_b += b[k] / static_cast<double>(n);
    }
    double ab = 0, aa = 0, bb = 0;
    for (std::size_t k = 0; k < n; ++k) {
        ab += (a[k] - mean_a).dot(b[k] - mean_b);
        aa += (a[k] - mean_a).squaredNorm();
        bb += (b[k] - mean_b).squaredNorm();
    }
    return aa > 0 && bb > 0 ? ab / std::sqrt(aa * bb) : 0;
}

/// Refuses sensor rocks of a test at the same place: their metadata are not complete.
void compare_positions(const std::vector<Recording>& recordings, std::vector<Finding>& findings) {
    constexpr double nearest = 5e-3; // m, far less than the size of a rock
    for (const Recording& r : recordings)
        for (const Recording& other : recordings)
            if (r.info.id != other.info.id && !r.strain.empty() && !other.strain.empty() &&
                (r.info.position() - other.info.position()).norm() < nearest) {
                findings.push_back({Finding::Kind::refusal, r.info.id, "position",
                                    fmt::format("expected a rock at a place of its own, found it "
                                                "at that of sensor {}: are x y z given?",
                                                other.info.id)});
                break;
            }
}

} // namespace

std::vector<Finding> check_recordings(const std::vector<Recording>& recordings, const Vec3& gravity,
                                      const QualityControlLimits& limits) {
    std::vector<Finding> findings;
    for (const Recording& r : recordings) QualityControl(r, gravity, limits, findings).run();
    for (std::size_t a = 0; a < recordings.size(); ++a)
        for (std::size_t b = a + 1; b < recordings.size(); ++b) {
            const unsigned first = recordings[a].info.id, second = recordings[b].info.id;
            if (!accepted(findings, first) || !accepted(findings, second) ||
                correlation(recordings[a].force, recordings[b].force) < limits.same)
                continue;
            for (const auto& [one, other] : {std::pair{first, second}, std::pair{second, first}})
                findings.push_back({Finding::Kind::refusal, one, "same",
                                    fmt::format("expected a recording of its own, found that of "
                                                "sensor {}",
                                                other)});
        }
    compare_positions(recordings, findings);
    compare_turns(recordings, limits, findings);
    compare_displacements(recordings, findings);
    return findings;
}

Finding note_on_unused(unsigned sensor, const std::vector<std::string>& fields) {
    constexpr std::size_t most = 10;
    const std::size_t shown = std::min(fields.size(), most);
    const std::string names =
        listed({fields.begin(), fields.begin() + static_cast<std::ptrdiff_t>(shown)}) +
        (shown < fields.size() ? ", ..." : "");
    return {Finding::Kind::note, sensor, "fields",
            fmt::format("{} of the file {} not used: {}", fields.size(),
                        fields.size() == 1 ? "is" : "are", names)};
}

bool accepted(const std::vector<Finding>& findings, unsigned sensor) {
    return std::ranges::none_of(findings, [&](const Finding& f) {
        return f.sensor == sensor && f.kind == Finding::Kind::refusal;
    });
}

} // namespace bris
