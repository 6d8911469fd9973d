#include "scenarios/ballast_box/load_band.hpp"

#include "engine/signal/fft.hpp"

#include <cmath>
#include <numeric>
#include <vector>

namespace bris {

double load_band(double speed, const RailOnTies& rails) {
    constexpr double share = 0.99, interval = 1e-3; // s
    const InfluenceLine influence = rails.influence();
    const auto half = static_cast<std::size_t>(rails.reach() / speed / interval);
    Fft fft(fast_length_for(8 * (2 * half + 1))); // with zeros, for narrow bins
    std::vector<double> load(fft.length(), 0);
    for (std::size_t k = 0; k <= 2 * half; ++k) {
        const double time = interval * (static_cast<double>(k) - static_cast<double>(half));
        load[k] = influence(speed * time); // the tie is at 0
    }
    std::vector<double> power;
    const double spacing = 1 / (interval * static_cast<double>(fft.length()));
    for (const auto& amplitude : fft.transform(load)) {
        const double frequency = spacing * static_cast<double>(power.size());
        power.push_back(std::norm(amplitude) * std::pow(frequency, 4));
    }
    const double wanted = share * std::accumulate(power.begin(), power.end(), 0.0);
    double below = 0;
    std::size_t bin = 0;
    while (bin + 1 < power.size() && below < wanted) below += power[bin++];
    return spacing * static_cast<double>(bin);
}

} // namespace bris
