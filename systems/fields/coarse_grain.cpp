#include "systems/fields/coarse_grain.hpp"

#include "components/body.hpp"
#include "components/kinds.hpp"
#include "components/pair.hpp"
#include "engine/clock.hpp"
#include "engine/ordering.hpp"
#include "systems/fields/smooth.hpp"

#include <algorithm>
#include <cmath>

namespace bris {

namespace {

constexpr std::array<std::array<int, 2>, 6> components{
    {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {0, 2}}};

/// A contact as a force along a branch, from the partner (or its surface) to the owner.
struct Branch {
    PairNames names;
    Vec3 force, from, to;
};

template <class Pairs>
void add_branches(const World& world, std::vector<Branch>& list) {
    if (!world.has<Pairs>()) return;
    const auto& index = world.resource<NearIndex<Pairs>>();
    const auto entry = world.column<typename Pairs::Near, NearPair>();
    const auto force = world.column<typename Pairs::Near, PairForce>();
    const auto names = world.column<Pairs, PairKey>();
    const auto rows = rows_by_id(world.column<Bodies, BodyId>());
    const auto position = world.column<Bodies, Position>();
    const auto mass = world.column<Bodies, Mass>();
    const std::size_t before = list.size();
    index.for_touching([&](Row k) {
        const ForceRow& f = force[k];
        const PairNames& pair = names[entry[k].pair];
        const Row partner = rows[pair.partner];
        list.push_back({pair, Vec3(f.fx, f.fy, f.fz),
                        mass[partner] > 0 ? position[partner] : Vec3(f.px, f.py, f.pz),
                        position[rows[pair.owner]]});
    });
    std::sort(list.begin() + static_cast<std::ptrdiff_t>(before), list.end(),
              [](const Branch& a, const Branch& b) { return a.names < b.names; });
}

/// Calls visit(voxel, share) for the voxels that a segment passes; the shares add up to 1.
template <class Visit>
void for_voxels_of(const Lattice& lattice, const Vec3& from, const Vec3& to, Visit&& visit) {
    std::vector<double> cuts{0, 1};
    for (int axis = 0; axis < 3; ++axis) {
        // faces lie half way between centres
        const double a = (from[axis] - lattice.origin[axis]) / lattice.size + 0.5,
                     b = (to[axis] - lattice.origin[axis]) / lattice.size + 0.5;
        for (double face = std::floor(std::min(a, b)) + 1; face < std::max(a, b); ++face)
            cuts.push_back((face - a) / (b - a));
    }
    std::ranges::sort(cuts);
    for (std::size_t k = 0; k + 1 < cuts.size(); ++k)
        if (const double share = cuts[k + 1] - cuts[k]; share > 0)
            visit(lattice.voxel_of(from + 0.5 * (cuts[k] + cuts[k + 1]) * (to - from)), share);
}

void add_motion(const World& world, CoarseFields& c, std::array<VoxelField, 3>& momentum) {
    const auto rows = in_order_of_ids(world.column<Bodies, BodyId>());
    const auto mass = world.column<Bodies, Mass>();
    const auto position = world.column<Bodies, Position>();
    const auto velocity = world.column<Bodies, Velocity>(),
               acceleration = world.column<Bodies, Acceleration>();
    const double half_step = 0.5 * world.resource<Clock>().dt,
                 per_volume = 1 / c.blocks.lattice().volume();
    for (const Row r : rows) {
        const std::uint32_t n = c.blocks.number(c.blocks.lattice().voxel_of(position[r]));
        if (!(mass[r] > 0) || n == VoxelBlocks::none) continue;
        const Vec3 v = velocity[r] + half_step * acceleration[r];
        c.mass_density[n] += mass[r] * per_volume;
        for (std::size_t k = 0; k < 3; ++k)
            momentum[k][n] += mass[r] * v[static_cast<Eigen::Index>(k)] * per_volume;
    }
}

void add_stress(CoarseFields& c, const std::vector<Branch>& branches) {
    const double per_volume = 1 / c.blocks.lattice().volume();
    for (const Branch& b : branches) {
        const Vec3 branch = b.to - b.from;
        for_voxels_of(c.blocks.lattice(), b.from, b.to, [&](const Voxel& v, double share) {
            const std::uint32_t n = c.blocks.number(v);
            if (n == VoxelBlocks::none) return;
            for (std::size_t k = 0; k < components.size(); ++k) {
                const auto [i, j] = components[k];
                c.stress[k][n] +=
                    0.5 * share * per_volume * (b.force[i] * branch[j] + b.force[j] * branch[i]);
            }
        });
    }
}

/// Derivative along an axis between the next voxels that have mass.
double slope(const CoarseFields& c, const VoxelField& field, std::uint32_t n, int axis) {
    const auto has_mass = [&](std::uint32_t m) {
        return m != VoxelBlocks::none && c.mass_density[m] > 0;
    };
    const std::uint32_t before = c.blocks.neighbour(n, 2 * axis),
                        after = c.blocks.neighbour(n, 2 * axis + 1);
    if (!has_mass(before) || !has_mass(after)) return 0;
    return (field[after] - field[before]) / (2 * c.blocks.lattice().size);
}

void add_strain_rate(CoarseFields& c) {
    for (std::uint32_t n = 0; n < c.blocks.voxels(); ++n) {
        if (!(c.mass_density[n] > 0)) continue;
        for (std::size_t k = 0; k < components.size(); ++k) {
            const auto [i, j] = components[k];
            c.strain_rate[k][n] = 0.5 * (slope(c, c.velocity[static_cast<std::size_t>(i)], n, j) +
                                         slope(c, c.velocity[static_cast<std::size_t>(j)], n, i));
        }
    }
}

} // namespace

CoarseFields coarse_grain(const World& world, const VoxelBlocks& blocks, int half_width) {
    CoarseFields c;
    c.blocks = widened(blocks, half_width + 1);
    c.mass_density = VoxelField(c.blocks);
    std::array<VoxelField, 3> momentum;
    momentum.fill(c.mass_density);
    c.strain_rate.fill(c.mass_density);
    add_motion(world, c, momentum);
    c.mass_density = smoothed(c.mass_density, c.blocks, half_width);
    for (std::size_t k = 0; k < 3; ++k) {
        c.velocity[k] = smoothed(momentum[k], c.blocks, half_width);
        for (std::uint32_t n = 0; n < c.blocks.voxels(); ++n)
            if (c.mass_density[n] > 0) c.velocity[k][n] /= c.mass_density[n];
    }
    add_strain_rate(c);
    std::vector<Branch> branches;
    for_each_kind_of_pair([&]<class Pairs>() { add_branches<Pairs>(world, branches); });
    c.has_stress = !branches.empty();
    if (!c.has_stress) return c;
    c.stress.fill(VoxelField(c.blocks));
    add_stress(c, branches);
    for (VoxelField& field : c.stress) field = smoothed(field, c.blocks, half_width);
    return c;
}

} // namespace bris
