#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include <vector>

namespace bris {

/// A rail as an Euler-Bernoulli beam without mass and with free ends, bent by its ties and by loads
/// between them. Its nodes are the ties; each has a deflection (m) and a slope, one after the other
/// in a vector of 2 n numbers. Beams of Hermite's cubics give the exact deflections at the nodes,
/// whatever acts between them (P. Tong, Int. J. Solids Struct. 5, 1969).
class RailBeam {
public:
    /// `at`: m along the rail, two or more, ascending; `bending`: N m2, E I, > 0.
    RailBeam(std::vector<double> at, double bending);

    const std::vector<double>& at() const { return at_; }
    Eigen::Index nodes() const { return static_cast<Eigen::Index>(at_.size()); }
    /// 2 n x 2 n: forces and moments that hold deflections and slopes (N/m, N, N m).
    Eigen::SparseMatrix<double> stiffness() const;
    /// Adds the forces and moments at the nodes by a force (N) at `x` (m); beyond the ends nothing
    /// acts.
    void add_force(double x, double force, Eigen::VectorXd& at_nodes) const;
    /// The same by a load along the whole rail (N/m).
    void add_line_load(double load, Eigen::VectorXd& at_nodes) const;
    /// m, deflection at `x` between two nodes between which nothing acts; 0 beyond the ends.
    double deflection(double x, const Eigen::VectorXd& of_nodes) const;

private:
    /// Number of the span in which `x` lies, n - 1: none. A place above a tie is of the span that
    /// ends there.
    std::size_t span_of(double x) const;

    std::vector<double> at_;
    double bending_;
};

} // namespace bris
