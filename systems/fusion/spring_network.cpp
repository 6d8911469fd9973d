#include "systems/fusion/spring_network.hpp"

#include "engine/errors.hpp"
#include "engine/signal/attitude.hpp"

#include <Eigen/Cholesky>
#include <fmt/format.h>

#include <cmath>
#include <utility>

namespace bris {

namespace {

using Mat6 = Eigen::Matrix<double, 6, 6, Eigen::DontAlign>;
using Rows3x6 = Eigen::Matrix<double, 3, 6, Eigen::DontAlign>;
using Motions = std::vector<Vector6>;

constexpr auto bad_stiffness = "fusion: contact network: expected stiffnesses that are finite and "
                               "positive, found others";

/// Matrix [1, -r x] that maps the shift and rotation of a body to the displacement of its point at
/// r.
Rows3x6 motion_at(const Vec3& r) {
    Rows3x6 m;
    m << Mat3::Identity(), -cross_matrix(r);
    return m;
}

Mat3 stiffness_of(const Joint& j) {
    return j.ks * Mat3::Identity() + (j.kn - j.ks) * j.normal * j.normal.transpose();
}

Vec3 stretch_of(const Joint& j, const Motions& motion) {
    Vec3 stretch = motion_at(j.arm) * motion[j.body];
    if (j.other != that_stays) stretch -= motion_at(j.other_arm) * motion[j.other];
    return stretch;
}

/// Forces and torques of the joints on bodies after a motion.
Motions forces_of_joints(const SpringNetwork& network, const Motions& motion) {
    Motions forces(motion.size(), Vector6::Zero());
    for (const Joint& j : network.joints) {
        const Vec3 force = -stiffness_of(j) * stretch_of(j, motion);
        forces[j.body] += motion_at(j.arm).transpose() * force;
        if (j.other != that_stays) forces[j.other] -= motion_at(j.other_arm).transpose() * force;
    }
    return forces;
}

// v -= m x and v -= m^T x, column by column: Eigen's own products are not vectorised here and take
// twice as long
void subtract_product(Vector6& v, const Mat6& m, const Vector6& x) {
    Vector6 remainder = v;
    for (Eigen::Index k = 0; k < 6; ++k) remainder -= m.col(k) * x[k];
    v = remainder;
}
void subtract_transposed_product(Vector6& v, const Mat6& m, const Vector6& x) {
    Vector6 remainder = v;
    for (Eigen::Index k = 0; k < 6; ++k) remainder -= m.row(k).transpose() * x[k];
    v = remainder;
}

double dot(const Motions& a, const Motions& b) {
    Vector6 sum = Vector6::Zero();
    for (std::size_t i = 0; i < a.size(); ++i) sum += a[i].cwiseProduct(b[i]);
    return sum.sum();
}

/// The stiffness A of joints and holds in blocks of 6 x 6: D_i for each body, and B_ik for each two
/// bodies that are joined (k < i). The blocks are stored divided by an incomplete factor of A that
/// has no more blocks than A: E_i = D_i - sum B_ik E_k^-1 B_ik^T = G_i G_i^T. E_i is positive
/// definite, because what is subtracted from D_i for a body k is never more than the joint has
/// added to it. In terms of v = G^T u the matrix is W + W^T - R, with W = 1 + L, L_ik = G_i^-1 B_ik
/// G_k^-T and R_i = 1 - sum L_ik L_ik^T.
class DividedStiffness {
public:
    explicit DividedStiffness(const SpringNetwork& network) : back_(network.holds.size()) {
        divide(assemble(network));
    }
    Motions divided(Motions forces) const; ///< W^-1 G^-1 f
    Motions undivided(Motions y) const;    ///< G^-T W^-T y
    /// product = W^-1 (W + W^T - R) W^-T y = W^-T y + W^-1 (y - R W^-T y), which needs only
    /// solutions with the factor (Eisenstat 1981).
    void multiply(const Motions& y, Motions& product);

private:
    struct Block {
        std::uint32_t column;
        Mat6 L;
    };
    std::vector<Mat6> assemble(const SpringNetwork& network);
    void divide(std::vector<Mat6> diagonal);
    void solve_forward(Motions& v) const;  ///< v := W^-1 v
    void solve_backward(Motions& v) const; ///< v := W^-T v

    std::vector<Block> blocks_;
    std::vector<std::size_t> first_; ///< index of each body's first block
    std::vector<Mat6> inverse_root_; ///< G^-1
    std::vector<Mat6> rest_;         ///< R
    Motions back_;                   ///< W^-T y
};

/// Stores B in the blocks and returns D.
std::vector<Mat6> DividedStiffness::assemble(const SpringNetwork& network) {
    std::vector<Mat6> diagonal;
    for (const Hold& h : network.holds) diagonal.emplace_back(h.stiffness.asDiagonal());
    first_.assign(diagonal.size() + 1, 0);
    blocks_.reserve(network.joints.size());
    for (const Joint& j : network.joints) {
        const Mat3 stiffness = stiffness_of(j);
        const Rows3x6 here = motion_at(j.arm), force = stiffness * here;
        diagonal[j.body].noalias() += here.transpose() * force;
        if (j.other == that_stays) continue;
        const Rows3x6 there = motion_at(j.other_arm);
        diagonal[j.other].noalias() += there.transpose() * (stiffness * there);
        if (first_[j.body + 1] == 0 || blocks_.back().column != j.other) {
            blocks_.push_back({j.other, Mat6::Zero()});
            ++first_[j.body + 1];
        }
        blocks_.back().L.noalias() -= force.transpose() * there;
    }
    for (std::size_t i = 0; i < diagonal.size(); ++i) first_[i + 1] += first_[i];
    return diagonal;
}

void DividedStiffness::divide(std::vector<Mat6> diagonal) {
    const std::size_t n = diagonal.size();
    inverse_root_.resize(n);
    rest_.assign(n, Mat6::Identity());
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t b = first_[i]; b < first_[i + 1]; ++b) {
            Mat6& L = blocks_[b].L;
            L = (L * inverse_root_[blocks_[b].column].transpose()).eval();
            diagonal[i].noalias() -= L * L.transpose();
        }
        const Eigen::LLT<Mat6> root(diagonal[i]);
        if (root.info() != Eigen::Success) throw SimulationError(bad_stiffness);
        inverse_root_[i] = root.matrixL().solve(Mat6::Identity());
        for (std::size_t b = first_[i]; b < first_[i + 1]; ++b) {
            Mat6& L = blocks_[b].L;
            L = (inverse_root_[i] * L).eval();
            rest_[i].noalias() -= L * L.transpose();
        }
    }
}

void DividedStiffness::solve_forward(Motions& v) const {
    for (std::size_t i = 0; i < v.size(); ++i)
        for (std::size_t b = first_[i]; b < first_[i + 1]; ++b)
            subtract_product(v[i], blocks_[b].L, v[blocks_[b].column]);
}

void DividedStiffness::solve_backward(Motions& v) const {
    for (std::size_t i = v.size(); i-- > 0;)
        for (std::size_t b = first_[i]; b < first_[i + 1]; ++b)
            subtract_transposed_product(v[blocks_[b].column], blocks_[b].L, v[i]);
}

Motions DividedStiffness::divided(Motions forces) const {
    for (std::size_t i = 0; i < forces.size(); ++i)
        forces[i] = (inverse_root_[i] * forces[i]).eval();
    solve_forward(forces);
    return forces;
}

Motions DividedStiffness::undivided(Motions y) const {
    solve_backward(y);
    for (std::size_t i = 0; i < y.size(); ++i) y[i] = (inverse_root_[i].transpose() * y[i]).eval();
    return y;
}

void DividedStiffness::multiply(const Motions& y, Motions& product) {
    back_ = y;
    solve_backward(back_);
    product = y;
    for (std::size_t i = 0; i < y.size(); ++i) subtract_product(product[i], rest_[i], back_[i]);
    solve_forward(product);
    for (std::size_t i = 0; i < y.size(); ++i) product[i] += back_[i];
}

} // namespace

std::vector<Vector6> motion_of_least_energy(const SpringNetwork& network, double tolerance) {
    const std::size_t n = network.holds.size();
    Motions motion;
    // start at the wanted displacements, where the holds exert no force
    for (const Hold& h : network.holds) motion.push_back(h.wanted);
    DividedStiffness stiffness(network);
    Motions y(n, Vector6::Zero()), missing = stiffness.divided(forces_of_joints(network, motion)),
                                   direction = missing, product(n);
    double square = dot(missing, missing);
    const double end = tolerance * tolerance * square;
    for (std::size_t iteration = 0; !(square <= end); ++iteration) { // conjugate gradients
        if (!std::isfinite(square)) throw SimulationError(bad_stiffness);
        if (iteration > 6 * n)
            throw SimulationError(fmt::format(
                "fusion: contact network: expected a relative error of its motion below {:g} after "
                "{} iterations, found {:.3g}",
                tolerance, iteration, tolerance * std::sqrt(square / end)));
        stiffness.multiply(direction, product);
        const double step = square / dot(direction, product);
        for (std::size_t i = 0; i < n; ++i) {
            y[i] += step * direction[i];
            missing[i] -= step * product[i];
        }
        const double before = std::exchange(square, dot(missing, missing));
        for (std::size_t i = 0; i < n; ++i)
            direction[i] = missing[i] + square / before * direction[i];
    }
    y = stiffness.undivided(std::move(y));
    for (std::size_t i = 0; i < n; ++i) motion[i] += y[i];
    return motion;
}

double energy_of_joints(const SpringNetwork& network, const std::vector<Vector6>& motion) {
    double sum = 0;
    for (const Joint& j : network.joints) {
        const Vec3 stretch = stretch_of(j, motion);
        sum += 0.5 * stretch.dot(stiffness_of(j) * stretch);
    }
    return sum;
}

} // namespace bris
