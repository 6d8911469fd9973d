#pragma once

#include "engine/io/column_map.hpp"
#include "scenarios/records/test_curves.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace bris {

/// A triaxial test in a CSV file as the laboratory has it.
struct LaboratoryTest {
    std::filesystem::path file;
    std::filesystem::path columns = {}; ///< column map; empty: the names of BRIS, or guessed
    double pressure = 0;                ///< Pa, confining
    double diameter = 0, height = 0;    ///< m, of the specimen before shearing; 0: not known
    std::filesystem::path guessed = {}; ///< file to which a guessed column map is written
};

/// Its curves, and what was done to the file on the way, one sentence each.
struct LaboratoryCurves {
    MeasuredCurves curves;
    std::vector<std::string> notes;
};

/// The columns that the file may have: those of machine_columns(), and what machines write in their
/// place: force and displacement of the piston, change of volume, the confining pressure.
const std::vector<KnownColumn>& laboratory_columns();

/// Reads the test. Strain, deviatoric stress and volumetric strain are taken if the file has them;
/// otherwise they are computed from displacement, force and change of volume (compression
/// positive) with the size of the specimen, the force over the present area
/// A0 (1 - volumetric strain) / (1 - axial strain). Records whose strain repeats or steps back, or
/// that have no number, are left out and counted. Throws InputError, naming --test, --columns,
/// --diameter, --height or --pressure: with the columns that were found if one is missing or
/// without a unit, if the size of the specimen is needed, if the file states another confining
/// pressure, or if most records would be left out. OutputError.
LaboratoryCurves read_laboratory_test(const LaboratoryTest& test);

} // namespace bris
