#include "engine/estimation/smoother.hpp"

#include <Eigen/Cholesky>

namespace bris {

std::vector<Gaussian> smooth(std::span<const FilterStep> steps) {
    std::vector<Gaussian> smoothed(steps.size());
    if (steps.empty()) return smoothed;
    smoothed.back() = steps.back().corrected;
    for (std::size_t k = steps.size() - 1; k-- > 0;) {
        const Gaussian &now = steps[k].corrected, &next = smoothed[k + 1];
        const FilterStep& step = steps[k + 1];
        const Matrix &F = step.transition.F, P = now.covariance();
        const Eigen::Index n = F.rows();
        const Matrix C = step.predicted.covariance().ldlt().solve(F * P).transpose();
        Matrix roots(n, 3 * n);
        roots << (Matrix::Identity(n, n) - C * F) * now.root, C * next.root,
            C * root_of<double>(step.transition.Q);
        smoothed[k].mean = now.mean + C * (next.mean - step.predicted.mean);
        smoothed[k].root = triangle_of<double>(roots);
    }
    return smoothed;
}

} // namespace bris
