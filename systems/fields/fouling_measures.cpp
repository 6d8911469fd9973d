#include "components/kinds.hpp"
#include "systems/fields/fouling.hpp"

#include <limits>

namespace bris {

void complete(FoulingMeasures& m, const FoulingSettings& s) {
    const double solids = m.fines_mass / s.density, all = m.fines_mass + m.ballast_mass;
    if (all > 0) {
        m.p4 = 100 * m.fines_mass / all;
        m.p200 = s.silt * m.p4;
        m.fouling_index = m.p4 + m.p200;
    }
    if (m.void_volume > 0) {
        m.contaminant_index = 100 * (1 + s.void_ratio) * solids / m.void_volume;
        m.void_contamination = 100 * (1 + s.least_void_ratio) * solids / m.void_volume;
    }
    if (m.void_volume > solids) m.saturation = 100 * m.water_volume / (m.void_volume - solids);
}

FoulingMeasures measure_fouling(const World& world, const Fouling& present) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    return measure_fouling(world, present, -infinity, infinity);
}

FoulingMeasures measure_fouling(const World& world, const Fouling& present, double low,
                                double high) {
    // voids above the highest rock and below the lowest are none of the ballast
    const BodySpheres bodies = spheres_of_bodies(world);
    double bottom = std::numeric_limits<double>::infinity(), top = -bottom;
    double mass = 0, volume = 0;
    for (std::size_t b = 0; b < bodies.bodies(); ++b) {
        if (!bodies.has_spheres(b)) continue;
        bottom = std::min(bottom, bodies.box[b].low.z());
        top = std::max(top, bodies.box[b].high.z());
        mass += world.column<Bodies, Mass>()[bodies.row[b]];
    }
    FoulingMeasures m;
    const VoxelBlocks& blocks = present.blocks;
    const double size = blocks.lattice().size, each = blocks.lattice().volume();
    double solid = 0;
    for (std::size_t b = 0; b < blocks.count(); ++b)
        for (std::size_t k = 0; k < VoxelBlocks::voxels_each; ++k) {
            const auto n = static_cast<std::uint32_t>(b * VoxelBlocks::voxels_each + k);
            const double z = blocks.lattice().centre(blocks.voxel(n)).z();
            volume += present.solid.solid()[n];
            if (z < low || z >= high) continue;
            solid += present.solid.solid()[n];
            m.fines_mass += present.fines[n];
            m.water_volume += present.water[n];
            // the part of the voxel between the lowest and the highest rock
            const double part = std::min(z + 0.5 * size, top) - std::max(z - 0.5 * size, bottom);
            if (part > 0)
                m.void_volume += each * present.solid.voids()[n] * std::min(1.0, part / size);
        }
    // solids have the mean density of all rocks
    m.ballast_mass = volume > 0 ? mass * (solid / volume) : 0;
    complete(m, present.settings);
    return m;
}

std::string fouling_class(double index) {
    if (index < 1) return "clean";
    if (index < 10) return "moderately clean";
    if (index < 20) return "moderately fouled";
    return index < 40 ? "fouled" : "highly fouled";
}

} // namespace bris
