#include "engine/estimation/low_discrepancy.hpp"

#include "engine/errors.hpp"

#include <cmath>

namespace bris {

std::vector<double> low_discrepancy_point(std::uint64_t number, std::size_t dimensions) {
    require(dimensions >= 1 && dimensions <= 16,
            "low-discrepancy sequence: expected 1 to 16 dimensions");
    double g = 2;
    for (int k = 0; k < 100; ++k) // converges, since the derivative is below 1/2
        g = std::pow(1 + g, 1 / static_cast<double>(dimensions + 1));
    std::vector<double> point(dimensions);
    double step = 1;
    for (double& x : point) {
        step /= g;
        x = std::fmod(0.5 + static_cast<double>(number) * step, 1.0);
    }
    return point;
}

} // namespace bris
