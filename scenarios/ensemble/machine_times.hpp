#pragma once

#include "scenarios/records/synchronise.hpp"

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

namespace bris {

/// When a test machine had which strain, as far as its records tell: they may come in any order,
/// and single ones may have a wrong time.
class MachineTimes {
public:
    static constexpr double same_strain = 1e-9; ///< tolerance of comparisons of axial strain

    /// Enters the t (s) at which the machine had a strain. `line`: number of the line that is
    /// processed. Strain and time increase together: returns false for a t that contradicts many
    /// others; one or two that contradict it are forgotten.
    bool enter_time(double t, double strain, std::uint64_t line);
    /// Enters the phase; returns false if phases decrease while the strain grows.
    bool enter_phase(double phase, double strain);
    const MachineClock& strain_at() const { return strain_at_; }
    double last_phase() const { return strain_at_.by_phase.rbegin()->first; }
    /// The largest t (s) when a line arrived; NaN: none.
    double last_t_at(std::uint64_t line) const;
    /// s at a strain, interpolated; NaN: the machine is not there yet, or has no clock.
    double time_at(double strain) const;
    /// s between records, the median; NaN: the machine has no clock.
    double step() const;

private:
    MachineClock strain_at_;
    std::map<double, double> by_strain_;                   // t
    std::vector<std::pair<std::uint64_t, double>> last_t_; // line, and the largest t from there on
};

} // namespace bris
