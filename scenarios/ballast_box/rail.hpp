#pragma once

#include "systems/loads/rail_beam.hpp"

#include <Eigen/Cholesky>

#include <span>
#include <vector>

namespace bris {

/// What carries a tie: pad, bed and subgrade in series, which push and do not pull.
struct TieSupport {
    double stiffness = 0; ///< N/m, > 0
    double gap = 0; ///< m, between bed and tie while the rail is straight; below 0: a high tie
};

/// N/m, of two springs in series; infinity stands for a rigid one.
inline double in_series(double a, double b) { return 1 / (1 / a + 1 / b); }

/// A load (N, downwards) at a place along the rail (m).
struct RailLoad {
    double at, force;
};

/// How a rail lies on its ties under loads.
struct RailDeflection {
    std::vector<double> reactions; ///< N, of the bed on each tie, >= 0; with the weights: the loads
    std::vector<double> at_ties;   ///< m, deflections of the rail, downwards
    std::size_t hanging = 0;       ///< ties that the bed does not carry
};

/// Part of a load at a place along the rail (m) that one tie carries while the bed carries all
/// ties. Below 0 where the load would lift the tie.
struct InfluenceLine {
    RailBeam beam;
    Eigen::VectorXd of_nodes;
    double operator()(double x) const { return beam.deflection(x, of_nodes); }
};

/// A rail on single ties, at rest: a beam with free ends that carries its ties, each on a spring
/// that only pushes, once its gap is closed: R = stiffness max(0, w - gap). Loads beyond its ends
/// do not act.
class TrackRail {
public:
    /// `at`: m, of the ties, two or more; `bending`: N m2, of all rails of the track together;
    /// `weight`: N, of rails, fastenings and tie at each tie. Throws InputError.
    TrackRail(std::vector<double> at, std::vector<TieSupport> supports, double bending,
              double weight);

    /// Under these loads and the weights. The set of the ties that are carried is found by
    /// exchange, all at once, or the first wrong one alone, which always ends (K. G. Murty,
    /// Opsearch 11, 1974). Throws InputError if the rail lies on fewer than two ties.
    RailDeflection under(std::span<const RailLoad> loads);
    /// m, TieSupport::gap: the bed of a tie has settled.
    void set_gap(std::size_t tie, double gap) { supports_[tie].gap = gap; }

    InfluenceLine influence_on(std::size_t tie) const;
    /// N/m, force on the rail at a tie over its deflection there if this tie is not carried and the
    /// bed carries all others.
    double stiffness_without(std::size_t tie) const;

private:
    using Set = std::vector<bool>;
    /// Deflections and slopes of the beam where the ties of a set are carried.
    Eigen::VectorXd solve(const Set& carried, const Eigen::VectorXd& loads);
    void factorise(const Set& carried);
    bool is_wrong(std::size_t tie, const Set& carried, const Eigen::VectorXd& nodes) const;

    RailBeam beam_;
    std::vector<TieSupport> supports_;
    double weight_;
    Set factorised_; ///< the set of the last solution, with which the next one begins
    Eigen::LLT<Eigen::MatrixXd> held_;
    Eigen::LLT<Eigen::MatrixXd> all_carried_;
};

} // namespace bris
