#pragma once

#include "engine/named_value.hpp"
#include "scenarios/ensemble/model_run.hpp"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace bris {

/// The axial strains at which a library keeps the results of its specimens.
struct LibraryAxis {
    double step = 1e-3; ///< between the strains of curves and rings
    std::size_t count = 80;
    std::size_t every = 5; ///< sensor rocks and displacement field are kept at every such strain

    double strain(std::size_t k) const { return step * static_cast<double>(k + 1); }
    std::size_t coarse_count() const { return count / every; }
    double coarse_strain(std::size_t k) const { return strain(every * (k + 1) - 1); }
    /// Half width (axial strain) of the window over which q is smoothed.
    static constexpr double half_window = 2.5e-3;
};

/// Cells of the mean displacement field: of equal height, and of equal area of the cross-section.
struct FieldCells {
    static constexpr std::size_t heights = 8, radii = 3, count = heights * radii;
};

/// Results of one specimen at one confining pressure; compression and outward are positive.
struct LibraryTest {
    std::vector<float> q;          ///< Pa, by strain
    std::vector<float> smoothed_q; ///< Pa, mean over the window around each strain
    std::vector<float> volume;     ///< volumetric strain, by strain
    std::vector<float> rings;      ///< radial strain, by strain and ring from below
    /// By coarse strain and sensor rock: displacement (m) outward, sideways and upward, and
    /// rotation vector (rad) about the same axes, at the start of shearing.
    std::vector<float> sensors;
    static constexpr std::size_t per_sensor = 6;
    /// By coarse strain and cell: mean displacement (m) outward and upward of the rocks that were
    /// in the cell at the start of shearing; 0 in a cell without rocks.
    std::vector<float> field;
};

/// One specimen of a library: its parameters and its tests.
struct LibrarySpecimen {
    std::uint64_t number = 0;  ///< of its point in the design
    std::uint64_t seed = 0;    ///< of its packing
    std::uint64_t redrawn = 0; ///< number of packings of this point that failed before
    RockParameters rocks;
    double porosity = 0;            ///< of the core, asked for
    double core_porosity = 0;       ///< at the start of shearing, mean over the tests
    double diameter = 0;            ///< m, of the mould
    std::vector<LibraryTest> tests; ///< by confining pressure
};

/// Results of many specimens on common strains, each with parameters and a packing of its own.
struct SpecimenLibrary {
    std::vector<NamedValue> settings; ///< those on which the specimens depend
    LibraryAxis axis;
    std::vector<double> pressures; ///< Pa
    std::size_t rings = 0, sensors = 0;
    std::vector<LibrarySpecimen> specimens; ///< in the order of their numbers
    /// Numbers of design points that were given up after several packings failed.
    std::vector<std::uint64_t> given_up;

    bool has(std::uint64_t number) const; ///< whether this point is done or given up
    void add(LibrarySpecimen specimen);   ///< inserts it in the order of the numbers
};

/// Components of a vector outward, sideways and upward, seen from a place beside the axis; only the
/// last one is not 0 on the axis.
Vec3 polar(const Vec3& v, const Vec3& place);

/// The results of a run on the strains of a library. Throws InputError if the run does not have a
/// stage at each of them.
LibraryTest sampled(const ModelRun& run, const LibraryAxis& axis);

/// Writes a library to an HDF5 file: arrays of float with one row for each specimen, and the
/// settings. The file is sealed and replaces an old one only when it is complete
/// (write_checkpoint). Throws OutputError.
void write_library(const std::filesystem::path& path, const SpecimenLibrary& library);

/// Reads a library. Throws InputError, naming the file, if it is damaged or not a library, and
/// OutputError if it cannot be read.
SpecimenLibrary read_library(const std::filesystem::path& path);

} // namespace bris
