#include "systems/fusion/work_budget.hpp"

#include "components/body.hpp"
#include "components/kinds.hpp"
#include "components/sensor.hpp"
#include "engine/errors.hpp"
#include "engine/ordering.hpp"
#include "systems/fusion/fuse.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace bris {

namespace {

/// Work of all boundaries, J: platens and membrane. That of a membrane that is pushed outwards is
/// negative.
double work_of_boundaries(const World& world) {
    return sum_by_id(rows_by_id(world.column<Bodies, BodyId>()),
                     world.column<Bodies, BoundaryWork>());
}

std::vector<double> work_of_corrections(const World& world) {
    const auto row = rows_by_id(world.column<Bodies, BodyId>());
    const auto work = world.column<Bodies, FusionWork>();
    std::vector<double> all;
    for (const EntityId host : world.column<Sensors, SensorHost>()) all.push_back(work[row[host]]);
    const double of_sensors = std::accumulate(all.begin(), all.end(), 0.0);
    all.push_back(sum_by_id(row, work) - of_sensors);
    return all;
}

/// Sum of magnitudes (J): work on one rock is not offset by negative work on another.
double spent(const std::vector<double>& now, const WorkBudget& budget) {
    double sum = 0;
    for (std::size_t k = 0; k < now.size(); ++k) sum += std::abs(now[k] - budget.work_done[k]);
    return sum;
}

// A share of 0.005 (the default of the scenario twin) over a ratio of a half is exactly
// least_share: the tolerance keeps rounding from deciding.
double if_enough(double share) { return share < least_share * (1 - 1e-9) ? 0 : share; }

/// Fraction of each correction such that all together do the allowed work.
double share_to_give(const WorkBudget& budget) {
    if (budget.expected <= budget.allowed) return 1;
    return if_enough(std::sqrt(budget.allowed / budget.expected));
}

} // namespace

void set_work_budget(World& world, double largest_share) {
    require(largest_share >= 0 && largest_share <= 1,
            fmt::format("work budget of the fusion: expected a share from 0 to 1 of the "
                        "boundaries' work, found {}",
                        largest_share));
    WorkBudget& budget = world.resource<Fusion>().budget;
    budget.largest_share = largest_share;
    if (largest_share == 0) return;
    budget.boundaries = work_of_boundaries(world);
    budget.work_done = work_of_corrections(world);
    budget.gain = 0;
}

void begin_analysis(World& world) {
    Fusion& fusion = world.resource<Fusion>();
    WorkBudget& a = fusion.budget;
    if (a.largest_share == 0) return;
    const bool is_active = fusion.nudging.stiffness > 0;
    const double boundaries = work_of_boundaries(world),
                 done = std::max(0.0, boundaries - a.boundaries);
    auto work_done = work_of_corrections(world);
    const double cost = spent(work_done, a), basis = is_active ? a.gain * done : a.basis;
    if (basis > 0)
        a.ratio = std::max(cost / basis, 0.5 * a.ratio);
    else if (a.allowed > 0)
        // corrections were too costly and are tried again; while there is a deficit, nothing is
        // tried and the ratio is kept
        a.ratio *= 0.5;
    a.deficit = std::max(0.0, a.deficit + cost - a.allowance);
    a.allowance = a.largest_share * done;
    a.allowed = std::max(0.0, a.allowance - a.deficit);
    a.boundaries = boundaries;
    a.work_done = std::move(work_done);
    a.basis = 0;
    a.expected = is_active ? a.ratio * done : WorkBudget::none;
    if (is_active) a.gain = a.expected > a.allowed ? if_enough(a.allowed / a.expected) : 1;
}

bool limits_corrections(const World& world) {
    const Fusion& fusion = world.resource<Fusion>();
    return fusion.budget.largest_share > 0 && !(fusion.nudging.stiffness > 0);
}

void limit_corrections(World& world, std::size_t first_record, double energy) {
    Fusion& fusion = world.resource<Fusion>();
    WorkBudget& budget = fusion.budget;
    if (!limits_corrections(world)) return;
    budget.expected = budget.ratio * energy;
    const double share = share_to_give(budget);
    budget.basis = share * share * energy;
    const auto row = rows_by_id(world.column<Bodies, BodyId>());
    const auto correction = world.column<Bodies, Correction>();
    for (std::size_t k = first_record; k < fusion.records.size(); ++k) {
        AnalysisRecord& r = fusion.records[k];
        r.work_expected = budget.expected;
        if (share == 1 || r.share == 0) continue; // r: rejected, or already withheld
        ++(share > 0 ? budget.reduced : budget.withheld);
        const auto s = static_cast<Row>(r.sensor);
        const CorrectionRow& c = correction[row[world.column<Sensors, SensorHost>()[s]]];
        fusion.filters[s].withhold(
            {.shift = (1 - share) * c.steps * c.shift, .turn = (1 - share) * c.steps * c.turn});
        r.share *= share;
    }
    if (share == 1) return;
    for (CorrectionRow& c : correction) {
        c.shift *= share;
        c.turn *= share;
        if (share == 0) c.steps = 0;
    }
}

void hold_nudging_forces(World& world) {
    const WorkBudget& budget = world.resource<Fusion>().budget;
    const bool too_costly = budget.largest_share > 0 && !std::isnan(budget.allowed) &&
                            spent(work_of_corrections(world), budget) > budget.allowed;
    const auto row = rows_by_id(world.column<Bodies, BodyId>());
    const auto nudging = world.column<Bodies, Nudging>();
    for (const EntityId host : world.column<Sensors, SensorHost>()) {
        NudgingRow& p = nudging[row[host]];
        if (!p.is_active()) continue;
        if (too_costly)
            release_nudging(p);
        else
            hold_nudging(p);
    }
}

void WorkBudget::save(Archive& archive, const std::string& path) const {
    put_fields(archive, path + "/numbers",
               std::tie(allowed, expected, gain, boundaries, allowance, deficit, basis, ratio,
                        reduced, withheld));
    archive.put(path + "/work_done", std::span<const double>(work_done));
}

void WorkBudget::load(const Archive& archive, const std::string& path) {
    get_fields(archive, path + "/numbers",
               std::tie(allowed, expected, gain, boundaries, allowance, deficit, basis, ratio,
                        reduced, withheld));
    work_done = archive.get<double>(path + "/work_done");
}

} // namespace bris
