#include "scenarios/ballast_box/rail.hpp"

#include "engine/errors.hpp"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>

namespace bris {

// Deflection (down): w(x) = a + b x + sum over point forces F (down) of F |x - x_F|^3 / (12 EI),
// whose moment and shear vanish beyond the ends when the forces and their moments balance. At a tie
// the reaction is R = support w, up.
std::vector<double> rail_reactions(std::span<const double> at, double support, double bending,
                                   double load) {
    require(!at.empty() && support > 0 && bending > 0 &&
                std::adjacent_find(at.begin(), at.end(), std::greater_equal<>()) == at.end(),
            "rail: expected ties at ascending positions and stiffnesses above 0");
    const auto n = static_cast<Eigen::Index>(at.size());
    if (n == 1) return {1};
    const auto influence = [&](double x, double force_at) {
        const double d = std::abs(x - force_at);
        return d * d * d / (12 * bending);
    };
    Eigen::MatrixXd a = Eigen::MatrixXd::Zero(n + 2, n + 2);
    Eigen::VectorXd b = Eigen::VectorXd::Zero(n + 2);
    for (Eigen::Index i = 0; i < n; ++i) {
        const double x = at[static_cast<std::size_t>(i)];
        for (Eigen::Index j = 0; j < n; ++j)
            a(i, j) = support * influence(x, at[static_cast<std::size_t>(j)]);
        a(i, i) += 1; // R_i - support (a + b x + P influence - sum R influence) = 0
        a(i, n) = -support;
        a(i, n + 1) = -support * x;
        b[i] = support * influence(x, load);
        a(n, i) = 1;     // sum R = 1
        a(n + 1, i) = x; // sum R x = load position
    }
    b[n] = 1;
    b[n + 1] = load;
    const Eigen::VectorXd solution = a.fullPivLu().solve(b);
    return {solution.data(), solution.data() + n};
}

} // namespace bris
