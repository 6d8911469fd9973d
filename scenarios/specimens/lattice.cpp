#include "scenarios/specimens/lattice.hpp"

#include "engine/errors.hpp"
#include "engine/random.hpp"

#include <fmt/format.h>

namespace bris {

std::vector<Vec3> lattice_sites(const Lattice& l, std::size_t count,
                                const std::function<bool(const Vec3&)>& inside) {
    std::array<int, 3> n{};
    for (int a = 0; a < 3; ++a)
        n[static_cast<std::size_t>(a)] = static_cast<int>((l.high[a] - l.low[a]) / l.pitch);
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
                sites.push_back(site + l.shift * l.pitch * random.uniform() * random.direction());
            }
    require(sites.size() == count,
            fmt::format(
                "lattice: expected room for {} spheres, found {}; choose fewer spheres or a taller "
                "vessel",
                count, sites.size()));
    return sites;
}

} // namespace bris
