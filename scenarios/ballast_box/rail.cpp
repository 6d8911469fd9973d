#include "scenarios/ballast_box/rail.hpp"

#include "engine/errors.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace bris {

namespace {

Eigen::Index node(std::size_t tie) { return 2 * static_cast<Eigen::Index>(tie); }

Eigen::LLT<Eigen::MatrixXd> factor_of(const RailBeam& beam, const std::vector<TieSupport>& supports,
                                      const std::vector<bool>& carried) {
    Eigen::MatrixXd held(beam.stiffness());
    for (std::size_t i = 0; i < supports.size(); ++i)
        if (carried[i]) held(node(i), node(i)) += supports[i].stiffness;
    return held.llt();
}

} // namespace

TrackRail::TrackRail(std::vector<double> at, std::vector<TieSupport> supports, double bending,
                     double weight)
    : beam_(std::move(at), bending), supports_(std::move(supports)), weight_(weight) {
    require(supports_.size() == beam_.at().size() && weight >= 0 &&
                std::ranges::all_of(supports_, [](const auto& s) { return s.stiffness > 0; }),
            fmt::format("rail: expected a support of a stiffness above 0 for each of {} ties and a "
                        "weight of at least 0, found {} supports and {:g} N",
                        beam_.at().size(), supports_.size(), weight));
    const Set all(supports_.size(), true);
    factorise(all);
    all_carried_ = held_;
}

void TrackRail::factorise(const Set& carried) {
    if (carried == factorised_) return;
    require(std::ranges::count(carried, true) > 1,
            "rail: expected a rail that lies on two ties or more, found a rail that is lifted off "
            "all others");
    held_ = factor_of(beam_, supports_, carried);
    factorised_ = carried;
}

Eigen::VectorXd TrackRail::solve(const Set& carried, const Eigen::VectorXd& loads) {
    factorise(carried);
    Eigen::VectorXd forces = loads;
    for (std::size_t i = 0; i < supports_.size(); ++i)
        if (carried[i]) forces[node(i)] += supports_[i].stiffness * supports_[i].gap;
    return held_.solve(forces);
}

bool TrackRail::is_wrong(std::size_t tie, const Set& carried, const Eigen::VectorXd& nodes) const {
    return carried[tie] != (nodes[node(tie)] > supports_[tie].gap);
}

RailDeflection TrackRail::under(std::span<const RailLoad> loads) {
    const std::size_t n = supports_.size();
    Eigen::VectorXd forces = Eigen::VectorXd::Zero(2 * beam_.nodes());
    for (std::size_t i = 0; i < n; ++i) forces[node(i)] = weight_;
    for (const RailLoad& load : loads) beam_.add_force(load.at, load.force, forces);
    Set carried = factorised_;
    Eigen::VectorXd nodes = solve(carried, forces);
    for (std::size_t round = 0;; ++round) {
        require(round < 1000 * n, "rail: expected ties whose contacts can be found, found none");
        const bool one_alone = round > n;
        bool is_right = true;
        for (std::size_t i = 0; i < n && (is_right || !one_alone); ++i)
            if (is_wrong(i, carried, nodes)) {
                carried[i] = !carried[i];
                is_right = false;
            }
        if (is_right) break;
        nodes = solve(carried, forces);
    }
    RailDeflection found;
    for (std::size_t i = 0; i < n; ++i) {
        const double w = nodes[node(i)];
        found.at_ties.push_back(w);
        found.reactions.push_back(carried[i] ? supports_[i].stiffness * (w - supports_[i].gap) : 0);
        if (!carried[i]) ++found.hanging;
    }
    return found;
}

// by reciprocity: the deflection at x under a unit load on the tie
InfluenceLine TrackRail::influence_on(std::size_t tie) const {
    Eigen::VectorXd force = Eigen::VectorXd::Zero(2 * beam_.nodes());
    force[node(tie)] = supports_[tie].stiffness;
    return {beam_, all_carried_.solve(force)};
}

double TrackRail::stiffness_without(std::size_t tie) const {
    const double share = influence_on(tie)(beam_.at()[tie]);
    return supports_[tie].stiffness * (1 - share) / share;
}

} // namespace bris
