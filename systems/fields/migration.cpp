#include "systems/fields/migration.hpp"

#include "engine/parallel.hpp"
#include "systems/fields/capacity.hpp"
#include "systems/fields/displace.hpp"
#include "systems/fields/hydraulics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace bris {

namespace {

constexpr double relative_exponent = 3.5; // Averjanov (1950)
constexpr int below = 4, above = 5;       // sides of a voxel

double contaminant_of(const Fouling& f, double fines, double voids) {
    return voids > 0 ? (1 + f.settings.void_ratio) * fines / (f.settings.density * voids) : 0;
}

/// The state before a step, which every voxel reads.
struct Before {
    const Fouling& f;
    VoxelField fines, water, fines_room, water_room;
    VoxelField conductivity; ///< m/s, of voxels with voids
    double size, volume;

    double voids(std::uint32_t n) const { return f.solid.voids()[n]; }

    /// Mass that passes from voxel n to its neighbour m in the direction `side`; negative: back.
    double fines_to(std::uint32_t n, std::uint32_t m, int side, double dt) const {
        const double area = size * size * std::min(voids(n), voids(m));
        if (!(area > 0)) return 0;
        const double cn = fines[n] / (volume * voids(n)), cm = fines[m] / (volume * voids(m));
        double flux = f.settings.diffusivity * (cn - cm) / size;
        const double speed = side == above   ? f.settings.pumping
                             : side == below ? -f.settings.pumping
                                             : 0;
        flux += speed > 0 ? speed * cn : speed * cm;
        // no more than a sixth of what one side has or the other can hold passes one face
        const double amount = flux * area * dt;
        const std::uint32_t from = amount > 0 ? n : m, to = amount > 0 ? m : n;
        const double most = std::min(fines[from], std::max(fines_room[to], 0.0)) / 6,
                     moved = floor_to(f.fines_unit, std::min(std::abs(amount), most));
        return amount > 0 ? moved : -moved;
    }
    /// m3/s, that sinks out of a voxel.
    double sinking(std::uint32_t n) const {
        const double pores = volume * voids(n) - fines[n] / f.settings.density;
        if (!(pores > 0)) return 0;
        const double s = std::min(water[n] / pores, 1.0);
        return size * size * conductivity[n] * std::pow(s, relative_exponent);
    }
};

Before before_step(const Fouling& f) {
    Before b{f,
             f.fines,
             f.water,
             fines_capacity(f),
             water_capacity(f),
             VoxelField(f.blocks),
             f.blocks.lattice().size,
             f.blocks.lattice().volume()};
    for_rows(f.blocks.voxels(), [&](std::uint32_t n) {
        b.fines_room[n] -= b.fines[n];
        b.water_room[n] -= b.water[n];
        if (!f.settings.drains || !(b.voids(n) > 0)) return;
        const double porosity = std::min(b.voids(n), 0.95);
        b.conductivity[n] = conductivity(f.settings, porosity,
                                         contaminant_of(f, b.fines[n], b.volume * b.voids(n)));
    });
    return b;
}

void step_fines(Fouling& f, const Before& b, double dt) {
    for_rows(f.blocks.voxels(), [&](std::uint32_t n) {
        if (!(b.voids(n) > 0)) return;
        double lost = 0;
        for (int side = 0; side < 6; ++side) {
            const std::uint32_t m = f.blocks.neighbour(n, side);
            if (m == VoxelBlocks::none || !(b.voids(m) > 0)) continue;
            // one expression for both sides of a face: that of its lower voxel
            lost += side % 2 == 1 ? b.fines_to(n, m, side, dt) : -b.fines_to(m, n, side + 1, dt);
        }
        f.fines[n] -= lost;
    });
}

/// Water of one column of voxels within the blocks [first, last), from below: what leaves a voxel
/// makes room for what enters it. Returns what leaves through the base.
double drain_column(Fouling& f, const Before& b, std::uint32_t first, std::uint32_t last,
                    std::uint32_t within, double dt) {
    double drained = 0, sent = 0;
    std::uint32_t under = VoxelBlocks::none;
    for (std::uint32_t block = first; block < last; ++block)
        for (std::uint32_t k = 0; k < VoxelBlocks::edge; ++k) {
            const std::uint32_t n = block * VoxelBlocks::voxels_each + within + k,
                                down = f.blocks.neighbour(n, below);
            if (!(b.voids(n) > 0)) continue;
            double flow = std::min(b.sinking(n) * dt, b.water[n]);
            if (down != VoxelBlocks::none && b.voids(down) > 0) {
                const double left = under == down ? sent : 0;
                flow = floor_to(f.water_unit,
                                std::min(flow, std::max(b.water_room[down], 0.0) + left));
                f.water[down] += flow;
            } else if (down == VoxelBlocks::none || f.solid.solid()[down] < 0.5) { // the base
                flow = floor_to(f.water_unit, flow);
                drained += flow;
            } else {
                flow = 0;
            }
            f.water[n] -= flow;
            sent = flow;
            under = n;
        }
    return drained;
}

void step_water(Fouling& f, const Before& b, double dt) {
    const std::vector<std::uint32_t> first = f.blocks.columns();
    std::vector<double> drained(first.size() - 1);
    for_chunks(drained.size(), 1, [&](std::size_t c, std::size_t, std::size_t) {
        for (std::uint32_t within = 0; within < VoxelBlocks::voxels_each;
             within += VoxelBlocks::edge)
            drained[c] += drain_column(f, b, first[c], first[c + 1], within, dt);
    });
    for (const double d : drained) f.drained += d;
}

double stable_step(const Before& b) {
    const FoulingSettings& s = b.f.settings;
    // 1/s, share of its content that a voxel gives. A face is never wider than the voxel is open,
    // so that a voxel gives no more through it than a voxel of voids only.
    double fastest = 0;
    if (b.f.fines_unit > 0)
        fastest = 6 * (s.diffusivity / (b.size * b.size) + std::abs(s.pumping) / b.size);
    if (s.drains && b.f.water_unit > 0)
        for (std::uint32_t n = 0; n < b.f.blocks.voxels(); ++n)
            if (b.water[n] > 0) // d(sinking)/d(water)
                fastest = std::max(fastest, relative_exponent * b.sinking(n) / b.water[n]);
    return fastest > 0 ? 0.5 / fastest : std::numeric_limits<double>::infinity();
}

} // namespace

double conductivity(const FoulingSettings& s, double porosity, double contaminant) {
    const double clean = filter_velocity(porosity, s.ballast_size, 1),
                 fines = kozeny_carman(s.void_ratio / (1 + s.void_ratio), s.size);
    return fouled_conductivity(clean, std::min(fines, clean), std::min(contaminant, 1.0));
}

double migration_step(const Fouling& f) { return stable_step(before_step(f)); }

void move_fines_and_water(Fouling& f, double duration) {
    for (double left = duration; left > 0;) {
        const Before b = before_step(f);
        const double most = stable_step(b), dt = std::min(left, most);
        if (f.fines_unit > 0 && (f.settings.diffusivity > 0 || f.settings.pumping != 0))
            step_fines(f, b, dt);
        if (f.water_unit > 0 && f.settings.drains) step_water(f, b, dt);
        left = dt < left ? left - dt : 0;
    }
}

} // namespace bris
