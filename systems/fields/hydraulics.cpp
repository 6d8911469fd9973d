#include "systems/fields/hydraulics.hpp"

#include <cmath>

namespace bris {

double kozeny_carman(double porosity, double size) {
    const double n = porosity;
    return water_density * weight_of_mass / water_viscosity * n * n * n * size * size /
           (180 * (1 - n) * (1 - n));
}

double reynolds_number(double velocity, double size) {
    return water_density * velocity * size / water_viscosity;
}

double filter_velocity(double porosity, double size, double gradient) {
    const double n = porosity, a = 1 / kozeny_carman(n, size),
                 b = 1.75 * (1 - n) / (weight_of_mass * n * n * n * size);
    // the root of b q^2 + a q - i in a form without cancellation
    return 2 * gradient / (a + std::sqrt(a * a + 4 * b * gradient));
}

double fouled_conductivity(double clean, double fines, double contaminant) {
    return clean * fines / (fines + contaminant * (clean - fines));
}

} // namespace bris
