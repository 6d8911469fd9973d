#include "scenarios/records/machine_quality_control.hpp"

#include "engine/signal/median.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

namespace bris {

namespace {

constexpr double begun = 2e-3;    // axial strain from which q is of the order of the pressure
constexpr std::size_t fewest = 3; // samples needed for a verdict

struct Range {
    double lower, upper;
};

/// Tolerated difference of a sample from its neighbours. The last sample has a tolerance of its
/// own, because only the next one can distinguish an outlier from a slip.
struct Neighbourhood {
    double start;               ///< assumed value before the first sample
    double floor, at_end;       ///< absolute part of the tolerance
    double share, share_at_end; ///< part relative to the neighbour, added to it
};

/// A channel of the machine from which wrong samples are removed.
class Channel {
public:
    Channel(std::string name, const std::vector<double>& strain, std::vector<double>& values,
            std::vector<Finding>& findings)
        : values_(values), name_(std::move(name)), strain_(strain), findings_(findings) {}

    double operator[](std::size_t k) const { return values_[k]; }
    bool is_measured(std::size_t k) const { return !std::isnan(values_[k]); }
    /// Rows with a number.
    std::vector<std::size_t> measured() const {
        std::vector<std::size_t> rows;
        for (std::size_t k = 0; k < values_.size(); ++k)
            if (is_measured(k)) rows.push_back(k);
        return rows;
    }

    void refuse(const std::string& text) {
        findings_.push_back({Finding::Kind::refusal, test_machine, name_, text});
        std::ranges::fill(values_, std::nan(""));
    }

    /// Removes values outside `range` of their row; `reason`: probable cause, for the text.
    void keep_within(auto&& range, auto&& reason, std::size_t long_run) {
        std::vector<std::size_t> out;
        const auto all = measured();
        std::size_t run = 0, longest = 0;
        for (const std::size_t k : all) {
            const Range r = range(k);
            const bool is_out = !(values_[k] >= r.lower && values_[k] <= r.upper);
            if (is_out) out.push_back(k);
            longest = std::max(longest, run = is_out ? run + 1 : 0);
        }
        if (out.empty()) return;
        const auto text = [&](std::size_t k) {
            return fmt::format(
                "expected {:.4g} to {:.4g}, found {:.4g} at {:.4g} % of axial strain{}",
                range(k).lower, range(k).upper, values_[k], 100 * strain_[k], reason(k));
        };
        if (longest < long_run && (out.size() < fewest || 2 * out.size() <= all.size()))
            return reject(out, all.size(), text(out.front()));
        refuse(fmt::format("{} of {} records are impossible: {}", out.size(), all.size(),
                           text(out.back()))); // the last is the most informative
    }

    void reject_outliers(const Neighbourhood& near) {
        const auto all = measured();
        std::vector<double> beside,
            deviation(all.size(), 0); // median of three, and distance from it if too large
        for (std::size_t i = 0; i < all.size(); ++i) {
            const bool last = i + 1 == all.size();
            const double x = values_[all[i]], before = i == 0 ? near.start : values_[all[i - 1]],
                         after = last ? before : values_[all[i + 1]];
            beside.push_back(std::clamp(x, std::min(before, after), std::max(before, after)));
            const double limit = last ? near.at_end + near.share_at_end * std::abs(beside[i])
                                      : near.floor + near.share * std::abs(beside[i]);
            if (std::abs(x - beside[i]) > limit) deviation[i] = std::abs(x - beside[i]);
        }
        std::vector<std::size_t> wild;
        std::optional<std::size_t> first;
        for (std::size_t i = 0; i < all.size(); ++i) {
            if (deviation[i] == 0 || (i > 0 && deviation[i - 1] > deviation[i]) ||
                (i + 1 < all.size() && deviation[i + 1] > deviation[i]))
                continue; // the neighbour is the outlier
            if (!first) first = i;
            wild.push_back(all[i]);
        }
        if (!first) return;
        const std::size_t k = wild.front();
        reject(
            wild, all.size(),
            fmt::format(
                "expected a value near {:.4g} as in neighbouring records, found {:.4g} at {:.4g} % "
                "of axial strain",
                beside[*first], values_[k], 100 * strain_[k]));
    }

    void reject_stuck(std::size_t samples, double length) {
        const auto all = measured();
        std::vector<std::size_t> stuck;
        std::string first;
        for (std::size_t begin = 0, end = 0; begin < all.size(); begin = end) {
            while (end < all.size() && values_[all[end]] == values_[all[begin]]) ++end;
            const double from = strain_[all[begin]], to = strain_[all[end - 1]];
            if (end - begin < samples || to - from < length * (1 - 1e-9)) continue;
            if (stuck.empty())
                first = fmt::format(
                    "expected a change, found {:.4g} from {:.4g} to {:.4g} % of axial strain",
                    values_[all[begin]], 100 * from, 100 * to);
            for (std::size_t i = begin + 1; i < end; ++i) stuck.push_back(all[i]);
        }
        if (stuck.empty()) return;
        if (stuck.size() + 1 == all.size()) return refuse(first);
        reject(stuck, all.size(), first);
    }

private:
    void reject(const std::vector<std::size_t>& rows, std::size_t of, const std::string& first) {
        for (const std::size_t k : rows) values_[k] = std::nan("");
        findings_.push_back({Finding::Kind::note, test_machine, name_,
                             fmt::format("{} of {} records left out: {}", rows.size(), of, first)});
    }

    std::vector<double>& values_;
    std::string name_;
    const std::vector<double>& strain_;
    std::vector<Finding>& findings_;
};

class MachineQualityControl {
public:
    MachineQualityControl(MeasuredCurves& measured, double pressure, const MachineLimits& limits)
        : measured_(measured), pressure_(pressure), limits_(limits),
          strain_(measured[quantity::axial_strain]) {}

    std::vector<Finding> run() {
        const std::size_t rings = measured_.rings();
        note_missing(quantity::volumetric_strain);
        for (std::size_t r = 0; r < rings; ++r) note_missing(quantity::ring_radius, r);
        check_strain();
        check_q();
        note_stiffness();
        for (std::size_t r = 0; r < rings; ++r) check_ring(r);
        check_volume(); // last, because the checked rings show whether its sign is right
        return std::move(findings_);
    }

private:
    Channel channel(const Quantity& q, std::size_t part = 0) {
        return Channel(title_of(q, part), strain_, measured_.column(q, part).values, findings_);
    }

    /// Reports missing numbers of a channel that is measured.
    void note_missing(const Quantity& q, std::size_t part = 0) {
        const auto missing = static_cast<std::size_t>(std::ranges::count_if(
            measured_.column(q, part).values, [](double x) { return std::isnan(x); }));
        if (missing > 0 && missing < measured_.size())
            findings_.push_back(
                {Finding::Kind::note, test_machine, title_of(q, part),
                 fmt::format("{} of {} records have no number", missing, measured_.size())});
    }

    /// Measurements at an unknown strain are useless: removes them with the strain.
    void check_strain() {
        std::vector<double> values = strain_; // which stay, as the order of the rows
        Channel strain(title_of(quantity::axial_strain), strain_, values, findings_);
        strain.keep_within(
            [&](std::size_t) {
                return Range{-0.1 * limits_.largest_strain, limits_.largest_strain};
            },
            [&](std::size_t k) {
                return strain[k] > 0 ? ": is it in per cent?" : ": is its sign reversed?";
            },
            limits_.long_run);
        for (std::size_t k = 0; k < measured_.size(); ++k) {
            if (strain.is_measured(k)) continue;
            for (const Quantity* q : {&quantity::deviatoric_stress, &quantity::volumetric_strain})
                measured_[*q][k] = std::nan("");
            for (std::size_t r = 0; r < measured_.rings(); ++r)
                measured_.column(quantity::ring_radius, r).values[k] = std::nan("");
        }
    }

    void check_q() {
        Channel q = channel(quantity::deviatoric_stress);
        check_level(q);
        q.keep_within(
            [&](std::size_t) {
                return Range{-pressure_, limits_.largest_q * pressure_};
            },
            [](std::size_t) { return ""; }, limits_.long_run);
        q.reject_outliers({.start = 0,
                           .floor = 0.1 * pressure_,
                           .at_end = 5 * pressure_,
                           .share = 0.5,
                           .share_at_end = 0.85});
        q.reject_stuck(limits_.same_samples, limits_.stuck_q);
    }

    /// The secant modulus at half of the largest q shows an axial strain in another unit where its
    /// size is possible.
    void note_stiffness() {
        double largest = 0;
        std::size_t records = 0;
        const std::vector<double>& q = measured_[quantity::deviatoric_stress];
        for (const double x : q) {
            if (std::isnan(x)) continue;
            largest = std::max(largest, x);
            ++records;
        }
        if (records < limits_.for_stiffness || largest < pressure_) return;
        const auto half = static_cast<std::size_t>(
            std::ranges::find_if(q, [&](double x) { return x >= 0.5 * largest; }) - // NaN: no
            q.begin());
        if (!(strain_[half] > 0)) return;
        const double stiffness = q[half] / strain_[half] / pressure_;
        if (stiffness >= limits_.least_stiffness && stiffness <= limits_.largest_stiffness) return;
        findings_.push_back(
            {Finding::Kind::note, test_machine, "axial_strain",
             fmt::format("half of the largest q is reached at {:.3g} % of axial strain: a secant "
                         "modulus of {:.3g} times the pressure, expected {:g} to {:g}: is the "
                         "strain in another unit?",
                         100 * strain_[half], stiffness, limits_.least_stiffness,
                         limits_.largest_stiffness)});
    }

    void check_level(Channel& q) const {
        const double small = limits_.smallest_q * pressure_;
        std::vector<double> sheared, later;
        for (const std::size_t k : q.measured()) {
            if (strain_[k] > 0) sheared.push_back(q[k]);
            if (strain_[k] >= begun) later.push_back(q[k]);
        }
        const auto negative = std::ranges::count_if(sheared, [&](double x) { return x < -small; });
        if (sheared.size() >= fewest && 2 * static_cast<std::size_t>(negative) > sheared.size())
            return q.refuse(fmt::format("expected positive values in compression, found {} of {} "
                                        "records negative: is its sign reversed?",
                                        negative, sheared.size()));
        if (later.size() < fewest || std::abs(median(later)) >= small) return;
        q.refuse(fmt::format(
            "expected at least {:.4g} Pa beyond {:.1f} % of axial strain, found {:.4g}{}", small,
            100 * begun, median(later), 1e3 * median(later) > small ? ": is it in kPa?" : ""));
    }

    void check_ring(std::size_t r) {
        Channel ring = channel(quantity::ring_radius, r);
        std::vector<double> radii;
        for (const std::size_t k : ring.measured()) radii.push_back(ring[k]);
        if (radii.empty()) return;
        const double middle = median(radii);
        if (radii.size() >= fewest && !(middle > 0 && middle < limits_.largest_ring))
            ring.refuse(fmt::format("expected a radius between 0 and {:g} m, found {:.4g}",
                                    limits_.largest_ring, middle));
        else if (middle > 0) {
            ring.keep_within(
                [&](std::size_t) {
                    return Range{(1 - limits_.ring_strain) * middle,
                                 (1 + limits_.ring_strain) * middle};
                },
                [](std::size_t) { return ""; }, limits_.long_run);
            ring.reject_outliers({.start = middle,
                                  .floor = 0.03 * middle,
                                  .at_end = 0.3 * middle,
                                  .share = 0,
                                  .share_at_end = 0});
        }
    }

    Range possible_volume(std::size_t k) const {
        const double axial = std::max(0.0, strain_[k]);
        return {-limits_.dilation * axial - limits_.first_volume,
                limits_.compaction * axial + limits_.first_volume};
    }

    void check_volume() {
        Channel volume = channel(quantity::volumetric_strain);
        check_sign(volume);
        volume.keep_within([&](std::size_t k) { return possible_volume(k); },
                           [&](std::size_t k) {
                               const auto fits = [&](double x) {
                                   return x >= possible_volume(k).lower &&
                                          x <= possible_volume(k).upper;
                               };
                               return fits(-volume[k]) ? ": is its sign reversed?"
                                      : fits(0.01 * volume[k]) || fits(-0.01 * volume[k])
                                          ? ": is it in per cent?"
                                          : "";
                           },
                           limits_.long_run);
        volume.reject_outliers(
            {.start = 0, .floor = 2e-3, .at_end = 2e-2, .share = 0.5, .share_at_end = 0.85});
        volume.reject_stuck(limits_.same_samples, limits_.stuck_volume);
    }

    /// Compares the volumetric strain with that from the ring radii. A dense specimen dilates
    /// early, and with a reversed sign looks like a loose one; the rings show whether it widens.
    void check_sign(Channel& volume) const {
        std::size_t compared = 0, reversed = 0, last = 0;
        for (const std::size_t k : volume.measured()) {
            const double of_rings = volume_of_rings(k);
            if (!(std::abs(of_rings) > limits_.first_volume)) continue;
            ++compared;
            if (std::abs(volume[k] + of_rings) > 0.5 * std::abs(of_rings)) continue;
            ++reversed;
            last = k;
        }
        if (compared < fewest || 2 * reversed <= compared) return;
        volume.refuse(fmt::format("expected {:.4g} at {:.4g} % of axial strain by the ring radii, "
                                  "found {:.4g}: is its sign reversed?",
                                  volume_of_rings(last), 100 * strain_[last], volume[last]));
    }

    /// Volumetric strain from the ring radii. NaN: not all rings were measured there, or at the
    /// beginning.
    double volume_of_rings(std::size_t k) const {
        if (measured_.rings() == 0) return std::nan("");
        double squares = 0, squares_before = 0;
        for (std::size_t r = 0; r < measured_.rings(); ++r) {
            const std::vector<double>& radii = measured_.ring(r);
            squares += radii[k] * radii[k];
            squares_before += radii.front() * radii.front();
        }
        return 1 - (1 - strain_[k]) * squares / squares_before;
    }

    MeasuredCurves& measured_;
    double pressure_;
    const MachineLimits& limits_;
    const std::vector<double>& strain_;
    std::vector<Finding> findings_;
};

} // namespace

std::vector<Finding> check_machine(MeasuredCurves& measured, double pressure,
                                   const MachineLimits& limits) {
    return MachineQualityControl(measured, pressure, limits).run();
}

} // namespace bris
