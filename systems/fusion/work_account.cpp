#include "systems/fusion/work_account.hpp"

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

/// Of all boundaries: platens and membrane, which does less than none where it is pushed outwards.
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

/// Sums sizes: what one rock gets is not made good by what is taken from another.
double spent(const std::vector<double>& now, const WorkAccount& account) {
    double sum = 0;
    for (std::size_t k = 0; k < now.size(); ++k) sum += std::abs(now[k] - account.booked[k]);
    return sum;
}

// A share of 0.005, the default of twin, over a ratio of a half is just the least share: roundings
// do not decide.
double if_enough(double share) { return share < least_share * (1 - 1e-9) ? 0 : share; }

/// Of a correction, such that all keep within what is allowed.
double share_to_give(const WorkAccount& account) {
    if (account.expected <= account.allowed) return 1;
    return if_enough(std::sqrt(account.allowed / account.expected));
}

} // namespace

void open_account(World& world, double largest_share) {
    require(
        largest_share >= 0 && largest_share <= 1,
        fmt::format(
            "work of the fusion: expected a share of 0 to 1 of that of the boundaries, found {}",
            largest_share));
    WorkAccount& account = world.resource<Fusion>().account;
    account.largest_share = largest_share;
    if (largest_share == 0) return;
    account.boundaries = work_of_boundaries(world);
    account.booked = work_of_corrections(world);
    account.gain = 0;
}

void begin_analysis(World& world) {
    Fusion& fusion = world.resource<Fusion>();
    WorkAccount& a = fusion.account;
    if (a.largest_share == 0) return;
    const bool pulls = fusion.pull.stiffness > 0;
    const double boundaries = work_of_boundaries(world),
                 done = std::max(0.0, boundaries - a.boundaries);
    auto booked = work_of_corrections(world);
    const double cost = spent(booked, a), basis = pulls ? a.gain * done : a.basis;
    if (basis > 0)
        a.ratio = std::max(cost / basis, 0.5 * a.ratio);
    else if (a.allowed > 0)
        a.ratio *= 0.5; // they were too dear, and will be tried again; while something is owed
                        // nothing is tried, nor forgotten
    a.owed = std::max(0.0, a.owed + cost - a.income);
    a.income = a.largest_share * done;
    a.allowed = std::max(0.0, a.income - a.owed);
    a.boundaries = boundaries;
    a.booked = std::move(booked);
    a.basis = 0;
    a.expected = pulls ? a.ratio * done : WorkAccount::none;
    if (pulls) a.gain = a.expected > a.allowed ? if_enough(a.allowed / a.expected) : 1;
}

bool limits_corrections(const World& world) {
    const Fusion& fusion = world.resource<Fusion>();
    return fusion.account.largest_share > 0 && !(fusion.pull.stiffness > 0);
}

void limit_corrections(World& world, std::size_t first_record, double energy) {
    Fusion& fusion = world.resource<Fusion>();
    WorkAccount& account = fusion.account;
    if (!limits_corrections(world)) return;
    account.expected = account.ratio * energy;
    const double share = share_to_give(account);
    account.basis = share * share * energy;
    const auto row = rows_by_id(world.column<Bodies, BodyId>());
    const auto correction = world.column<Bodies, Correction>();
    for (std::size_t k = first_record; k < fusion.records.size(); ++k) {
        AnalysisRecord& r = fusion.records[k];
        r.work_expected = account.expected;
        if (share == 1 || r.share == 0) continue; // r: refused, or withheld before
        ++(share > 0 ? account.reduced : account.withheld);
        const auto s = static_cast<Row>(r.sensor);
        const CorrectionRow& c = correction[row[world.column<Sensors, SensorHost>()[s]]];
        fusion.filters[s].leave(
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

void hold_pulls(World& world) {
    const WorkAccount& account = world.resource<Fusion>().account;
    const bool too_dear = account.largest_share > 0 && !std::isnan(account.allowed) &&
                          spent(work_of_corrections(world), account) > account.allowed;
    const auto row = rows_by_id(world.column<Bodies, BodyId>());
    const auto pull = world.column<Bodies, Pull>();
    for (const EntityId host : world.column<Sensors, SensorHost>()) {
        PullRow& p = pull[row[host]];
        if (!p.pulls()) continue;
        if (too_dear)
            release_pull(p);
        else
            hold_pull(p);
    }
}

void WorkAccount::save(Archive& archive, const std::string& path) const {
    put_fields(archive, path + "/numbers",
               std::tie(allowed, expected, gain, boundaries, income, owed, basis, ratio, reduced,
                        withheld));
    archive.put(path + "/booked", std::span<const double>(booked));
}

void WorkAccount::load(const Archive& archive, const std::string& path) {
    get_fields(archive, path + "/numbers",
               std::tie(allowed, expected, gain, boundaries, income, owed, basis, ratio, reduced,
                        withheld));
    booked = archive.get<double>(path + "/booked");
}

} // namespace bris
