#include "engine/signal/median.hpp"
#include "scenarios/sensors/inspection.hpp"

#include <cmath>

namespace bris {

namespace {

constexpr double slack = 1e-3; // strain from which ratios mean something

/// Why these strains, from the first sample to the last, are not those of a test that begins
/// without strain and compresses further and further; "".
std::string reason_against_course(const std::vector<double>& strains) {
    constexpr std::size_t fewest = 10;
    if (strains.size() < fewest) return {};
    const auto moved = std::ranges::find_if(strains, [&](double e) { return e != strains[0]; });
    if (const auto still = moved - strains.begin(); still >= 3 && strains[0] > slack)
        return fmt::format(
            "expected 0 before the test, found {:.4g} in the first {} samples: is it "
            "shifted?",
            strains[0], still);
    std::vector<double> sorted = strains;
    std::ranges::sort(sorted);
    const double high = sorted[sorted.size() * 9 / 10],
                 late = median(
                     std::vector(strains.end() - static_cast<std::ptrdiff_t>(strains.size() / 10),
                                 strains.end()));
    if (!(high > slack) || late > 0.5 * high) return {};
    return fmt::format("expected strains that grow, found more than {:.4g} in a tenth of the "
                       "samples, but a median of {:.4g} in the last tenth",
                       high, late);
}

} // namespace

bool has_possible_strain(const Inspection& at) {
    const auto strains = finite_of(at.recording.strain);
    if (strains.empty()) return true;
    const double most = at.limits.largest_strain;
    const auto outside = [&](double e) { return !(e >= -0.1 * most && e <= most); };
    const auto wrong = std::ranges::count_if(strains, outside);
    const auto negative = std::ranges::count_if(strains, [](double e) { return e < -1e-3; });
    if (2 * static_cast<std::size_t>(negative) > strains.size()) {
        at.refuse("strain", fmt::format("expected positive values in compression, found {} of {} "
                                        "negative: is its sign reversed?",
                                        negative, strains.size()));
        return false;
    }
    if (wrong == 0) {
        const std::string reason = reason_against_course(strains);
        if (!reason.empty()) at.refuse("strain", reason);
        return reason.empty();
    }
    const double worst =
        *std::ranges::max_element(strains, {}, [](double e) { return std::abs(e); });
    at.refuse("strain", fmt::format("expected {:g} to {:g}, which a test can reach, found {} of {} "
                                    "samples outside, up to {:.4g}{}",
                                    -0.1 * most, most, wrong, strains.size(), worst,
                                    worst > 0 && worst < 100 ? ": is it in per cent?" : ""));
    return false;
}

} // namespace bris
