#include "scenarios/specimens/lattice.hpp"

#include "engine/errors.hpp"
#include "engine/random.hpp"

#include <fmt/format.h>

namespace bris {

std::vector<Vec3> lattice_sites(const SiteLattice& l, std::size_t count,
                                const std::function<bool(const Vec3&)>& inside) {
    constexpr double most = 1e9;
    const Vec3 places = (l.high - l.low) / l.pitch;
    require(places.prod() <= most,
            fmt::format("lattice: expected a vessel with at most {:g} places at a distance of "
                        "{:g} m, found one of {:.3g} x {:.3g} x {:.3g} m",
                        most, l.pitch, l.high.x() - l.low.x(), l.high.y() - l.low.y(),
                        l.high.z() - l.low.z()));
    std::array<int, 3> n{};
    for (int a = 0; a < 3; ++a) n[static_cast<std::size_t>(a)] = static_cast<int>(places[a]);
    const Vec3 middle = 0.5 * (l.low + l.high);
    std::vector<Vec3> sites;
    for (int k = 0; k < n[2]; ++k)
        for (int j = 0; j < n[1]; ++j)
            for (int i = 0; i < n[0]; ++i) {
                if (sites.size() == count) return sites;
                // centred in x and y, from the floor upwards in z
                const Vec3 site(middle.x() + l.pitch * (i - 0.5 * (n[0] - 1)),
                                middle.y() + l.pitch * (j - 0.5 * (n[1] - 1)),
                                l.low.z() + l.pitch * (k + 0.5));
                if (!inside(site)) continue;
                Random random(l.seed, sites.size());
                const Vec3 direction = random.direction();
                sites.push_back(site + l.shift * l.pitch * random.uniform() * direction);
            }
    require(sites.size() == count,
            fmt::format(
                "lattice: expected room for {} spheres, found {}; choose fewer spheres or a taller "
                "vessel",
                count, sites.size()));
    return sites;
}

} // namespace bris
