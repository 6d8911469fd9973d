#include "systems/fields/displace.hpp"

#include <algorithm>
#include <cmath>

namespace bris {

namespace {

constexpr int farthest = 10; // voxels

/// Offsets of voxels at the same distance.
using Shell = std::vector<Voxel>;

std::vector<Shell> make_shells() {
    std::vector<Shell> by_square(farthest * farthest + 1);
    for (int x = -farthest; x <= farthest; ++x)
        for (int y = -farthest; y <= farthest; ++y)
            for (int z = -farthest; z <= farthest; ++z)
                if (const int square = x * x + y * y + z * z;
                    square > 0 && square <= farthest * farthest)
                    by_square[static_cast<std::size_t>(square)].push_back({x, y, z});
    std::erase_if(by_square, [](const Shell& shell) { return shell.empty(); });
    return by_square;
}

struct Free {
    std::uint32_t number;
    double room;
};

/// Gives what it can of the excess to voxels with room, and returns what remains.
double share_out(double excess, std::vector<Free>& free, VoxelField& amount, double unit) {
    double room = 0;
    for (const Free& f : free) room += f.room;
    const double share = std::min(1.0, excess / room);
    double left = excess;
    for (Free& f : free) {
        const double given = share < 1 ? floor_to(unit, share * f.room) : f.room;
        amount[f.number] += given;
        f.room -= given;
        left -= given;
    }
    for (const Free& f : free) { // what rounding has left
        if (share == 1 || left == 0) break;
        const double given = std::min(left, f.room);
        amount[f.number] += given;
        left -= given;
    }
    return left;
}

} // namespace

double exact_unit(double total) {
    int exponent = 0;
    (void)std::frexp(total, &exponent);
    return std::ldexp(1.0, exponent - 51);
}

double displace_excess(VoxelField& amount, const VoxelBlocks& blocks, const VoxelField& capacity,
                       double unit) {
    static const std::vector<Shell> shells = make_shells();
    double stuck = 0;
    std::vector<Free> free;
    for (std::size_t b = 0; b < blocks.count(); ++b)
        for (std::size_t k = 0; k < VoxelBlocks::voxels_each; ++k) {
            double& here = amount.block(b)[k];
            const double most = floor_to(unit, capacity.block(b)[k]);
            if (here <= most) continue;
            double excess = here - most;
            here = most;
            const Voxel at =
                blocks.voxel(static_cast<std::uint32_t>(b * VoxelBlocks::voxels_each + k));
            for (const Shell& shell : shells) {
                if (excess == 0) break;
                free.clear();
                for (const Voxel& o : shell) {
                    const auto n = blocks.number({at.x + o.x, at.y + o.y, at.z + o.z});
                    if (n == VoxelBlocks::none) continue;
                    const double room = floor_to(unit, capacity[n]) - amount[n];
                    if (room > 0) free.push_back({n, room});
                }
                if (!free.empty()) excess = share_out(excess, free, amount, unit);
            }
            here += excess;
            stuck += excess;
        }
    return stuck;
}

} // namespace bris
