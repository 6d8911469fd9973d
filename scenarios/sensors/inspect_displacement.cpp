#include "engine/signal/median.hpp"
#include "scenarios/sensors/inspection.hpp"

namespace bris {

namespace {

/// Refuses a lasting jump, which is not a motion of the rock. A single outlier is left to the
/// users of the recording.
void check_jumps(const Inspection& at) {
    const Recording& r = at.recording;
    const auto& u = r.displacement;
    for (std::size_t k = 2; k + 1 < u.size(); ++k) {
        const double jump = (u[k] - u[k - 1]).norm();
        const bool was_there = (u[k - 1] - u[k - 2]).norm() < 0.5 * jump,
                   stays = (u[k + 1] - u[k]).norm() < 0.5 * jump;
        const bool at_once =
            r.time[k] - r.time[k - 1] < 3 / r.info.sampling_rate; // in a gap the rock may move far
        if (jump > at.limits.jump && was_there && stays && at_once)
            return at.refuse("jump",
                             fmt::format("the displacement jumps by {:.1f} mm at t = {:.6g} s and "
                                         "does not return, expected at most {:.1f} mm",
                                         1e3 * jump, r.time[k], 1e3 * at.limits.jump));
    }
}

double height_of_specimen(const Inspection& at) {
    return std::max(at.limits.height, 2 * at.recording.info.z);
}

/// The platen drives all motion: a rock moves at most about as far as the platen, or slips once.
void check_lengths(const Inspection& at) {
    const Recording& r = at.recording;
    const Vec3 start = at.still > 0 ? at.median_before_test(r.displacement) : Vec3(Vec3::Zero());
    std::size_t outliers = 0, first = 0;
    const auto compared =
        std::ranges::count_if(r.strain, [](double e) { return std::isfinite(e); });
    const auto displacement = [&](std::size_t k) { return (r.displacement[k] - start).norm(); };
    const auto longest = [&](std::size_t k) {
        return 2 * r.strain[k] * height_of_specimen(at) + at.limits.jump +
               5 * r.info.displacement_noise;
    };
    for (std::size_t k = at.still; k < r.strain.size(); ++k)
        if (displacement(k) > longest(k) && outliers++ == 0) first = k;
    if (outliers <= 3 ||
        static_cast<double>(outliers) <= at.limits.outlier_share * static_cast<double>(compared))
        return;
    at.refuse(
        "displacement",
        fmt::format("in {} of {} samples it is larger than the axial strain permits, the first at "
                    "{:.3f} % of axial strain: expected at most {:.1f} mm, found {:.1f} mm",
                    outliers, compared, 100 * r.strain[first], 1e3 * longest(first),
                    1e3 * displacement(first)));
}

/// The rock moves only while the specimen is compressed: if it moves before, its strain or its
/// clock is late. Compares the last samples before the test with those of the time at rest.
void check_start(const Inspection& at) {
    constexpr std::size_t fewest = 3;
    constexpr double clearly = 5, least = 3e-4; // times the noise; m
    const Recording& r = at.recording;
    std::vector<Vec3> before;
    for (std::size_t k = 0; k < r.size() && !(r.strain[k] > 0); ++k)
        if (r.strain[k] == 0) before.push_back(r.displacement[k]);
    if (at.still < fewest || before.size() < at.still + fewest) return;
    const std::vector<Vec3> rest(before.begin(),
                                 before.begin() + static_cast<std::ptrdiff_t>(at.still)),
        last(before.end() - fewest, before.end());
    const double moved = (median(last) - median(rest)).norm();
    if (moved < std::max(clearly * r.info.displacement_noise, least)) return;
    at.refuse("clock", fmt::format("the rock moves by {:.1f} mm while its axial strain is 0: its "
                                   "strain or its clock seems to be late",
                                   1e3 * moved));
}

} // namespace

void check_displacement(const Inspection& at) {
    const Recording& r = at.recording;
    if (r.displacement.empty() ||
        is_stuck(at, "displacement", r.displacement, r.info.displacement_noise) ||
        has_stuck_axis(at, "displacement", r.displacement))
        return;
    constexpr double farthest = 100; // m
    const auto possible = [](const Vec3& u) { return u.cwiseAbs().maxCoeff() <= farthest; };
    if (const auto wrong = std::ranges::find_if_not(r.displacement, possible);
        wrong != r.displacement.end())
        return at.refuse("displacement", fmt::format("expected at most {:g} m, found {:.4g} m",
                                                     farthest, wrong->cwiseAbs().maxCoeff()));
    check_jumps(at);
    check_scatter(at, "displacement", r.displacement, r.info.displacement_noise,
                  height_of_specimen(at) * strain_step(at), "mm", 1e-3);
    if (!r.strain.empty()) {
        check_lengths(at);
        check_start(at);
    }
}

} // namespace bris
