#pragma once

#include "systems/fields/fouling.hpp"
#include "systems/fields/vdb_file.hpp"

namespace bris {

/// How the fields of a world are computed for files and pictures.
struct FieldSetSettings {
    double voxel = 5e-3;  ///< m, > 0; a scene with fouling has that of its fields
    unsigned samples = 4; ///< lines across each edge of a voxel (SolidFraction)
    /// m, half width of the kernel over which velocity, stress and the measures of fouling are
    /// averaged; 0: the mean bounding radius of the rocks.
    double averaging = 0;
};

/// The fields of a world at one time, on one set of blocks.
struct FieldSet {
    struct Field {
        std::string name, units, quantity;
        std::vector<VoxelField> components; ///< one, or three of a vector
    };
    VoxelBlocks blocks;
    VoxelField shown; ///< 1 for voxels within the ballast and below its surface, otherwise 0
    std::vector<Field> fields;
    MeasuredVolume solids;
    double void_volume = 0; ///< m3, of the voxels shown; 0 without a container
    double averaging = 0;   ///< m, as used
    bool has_stress = false;

    /// Null if there is none of that name.
    const Field* find(const std::string& name) const;
    std::vector<FieldToWrite> to_write() const;
};

/// Always: `density` (fraction of solids), its error, `porosity`, `velocity`, `shear_strain_rate`.
/// After steps in this process: `mean_stress`, `stress_zz`. With fields of fouling: `fines`,
/// `fouling` (void contaminant index), `fouling_index`, `saturation`. Reads only.
FieldSet fields_of(const World& world, const FieldSetSettings& settings);

/// Writes NAME.vdb and NAME.vtkhdf. Throws OutputError.
void write_fields(const FieldSet& set, const std::filesystem::path& folder, const std::string& name,
                  double time, const std::vector<NamedValue>& meta);

/// Draws a vertical slice through the middle of the ballast along its longer side, one panel for
/// each field named that exists. Returns false, with a line on stderr, if it cannot be drawn.
bool draw_slice(const FieldSet& set, const std::vector<std::string>& names,
                const std::filesystem::path& png);

} // namespace bris
