#include "scenarios/ensemble/machine_times.hpp"

#include "engine/signal/median.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace bris {

namespace {

// of the machine's strain while time goes on
constexpr double largest_step_back = 5e-4;
constexpr std::ptrdiff_t most_wrong_times = 2;

} // namespace

bool MachineTimes::enter_time(double t, double strain, std::uint64_t line) {
    auto& times = strain_at_.by_time;
    const auto later = times.upper_bound(t);
    auto first = later, last = later;
    while (first != times.begin() && std::prev(first)->second > strain + largest_step_back) --first;
    while (last != times.end() && last->second < strain - largest_step_back) ++last;
    if (std::distance(first, last) > most_wrong_times) return false;
    for (auto wrong = first; wrong != last; ++wrong) by_strain_.erase(wrong->second);
    times.erase(first, last);
    times.emplace(t, strain);
    by_strain_.emplace(strain, t);
    last_t_.emplace_back(line, times.rbegin()->first);
    return true;
}

bool MachineTimes::enter_phase(double phase, double strain) {
    auto& phases = strain_at_.by_phase;
    const auto last = phases.rbegin();
    if (last != phases.rend() && phase < last->first && strain >= last->second) return false;
    phases.emplace(phase, strain);
    return true;
}

double MachineTimes::last_t_at(std::uint64_t line) const {
    const auto after =
        std::ranges::upper_bound(last_t_, line, {}, &std::pair<std::uint64_t, double>::first);
    return after == last_t_.begin() ? std::nan("") : std::prev(after)->second;
}

double MachineTimes::time_at(double strain) const {
    const auto after = by_strain_.lower_bound(strain - same_strain);
    if (after == by_strain_.end()) return std::nan("");
    if (after->first <= strain + same_strain || after == by_strain_.begin()) return after->second;
    const auto before = std::prev(after);
    const double share = (strain - before->first) / (after->first - before->first);
    return before->second + share * (after->second - before->second);
}

double MachineTimes::step() const {
    const auto& times = strain_at_.by_time;
    std::vector<double> steps;
    for (auto at = times.begin(); at != times.end() && std::next(at) != times.end(); ++at)
        steps.push_back(std::next(at)->first - at->first);
    return steps.empty() ? std::nan("") : median(std::move(steps));
}

} // namespace bris
