#pragma once

#include "scenarios/records/synchronise.hpp"
#include "scenarios/records/test_curves.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace bris {

class Hdf5Content;

/// Measurements of a test machine, record by record.
struct MachineRecord {
    MeasuredCurves curves; ///< strain, q, volumetric strain and ring radii
    MachineClock clock = {};
    std::vector<std::string> unused = {}; ///< fields of the file that are no measurement
};

/// Whether a file of recordings has the group /bench. Throws OutputError.
bool has_machine_record(const std::filesystem::path& path);

/// Reads the group /bench of an HDF5 file. Datasets with one number per record: time (s), strain
/// (axial), force (N, deviatoric: of the piston without the share of the confining pressure) and
/// confining (Pa). Optional: volumetric_strain, phase, and ring_radius (n x rings, m). Attribute
/// area: of the specimen at the start (m2). The deviatoric stress is the force over the current
/// area, area (1 - volumetric strain) / (1 - axial strain) (ASTM D7181), with the last measured
/// volumetric strain. `pressure`: Pa. Throws InputError for wrong shapes or numbers, or if the
/// median of the confining pressure differs from `pressure` by 5 % or more; OutputError if the file
/// cannot be read.
MachineRecord read_machine_record(const std::filesystem::path& path, double pressure);
/// The same of a file whose group /bench has been read.
MachineRecord machine_record_in(const Hdf5Content& file, double pressure);

/// Adds the group /bench to a file of recordings. `time`: s, of each row; `area`: m2; `pressure`:
/// Pa. Throws OutputError.
void write_machine_record(const std::filesystem::path& path, const TestCurves& curves,
                          const std::vector<double>& time, double area, double pressure);

} // namespace bris
