#pragma once

#include "engine/io/column_map.hpp"

#include <map>
#include <string>
#include <vector>

namespace bris {

/// What is known about a file of another make besides its numbers. 0: not known.
struct FileEvidence {
    double pressure = 0;     ///< Pa, confining, of the test
    double duration = 0;     ///< s, of the test by the clock of the machine
    double final_strain = 0; ///< axial, at its end
    double rate = 0;         ///< Hz, sampling rate that the file states above its table
};

/// Numbers of a file by the names of BRIS, row by row; NaN: none. Those in `scale` have a unit that
/// is known: scale * number + offset is the value in the unit of BRIS.
struct FileNumbers {
    std::map<std::string, std::vector<double>> of;
    std::map<std::string, ColumnUnit> unit;

    bool has(const std::string& name) const { return of.contains(name); }
    /// Whether the unit of the column is known.
    bool is_known(const std::string& name) const { return unit.contains(name); }
    /// Largest magnitude in the unit of BRIS, as far as `as` or the known unit tells; NaN: none.
    double largest(const std::string& name, const ColumnUnit& as) const;
    double largest(const std::string& name) const { return largest(name, unit.at(name)); }
};

/// Units of a column without a stated unit that fit what else is known, and why.
struct PossibleUnits {
    std::vector<ColumnUnit> units; ///< exactly one: it can be taken
    std::string reason;            ///< for one: why only this one is possible
};

/// Which of its units the column `name` may have: accelerations by gravity, the field of
/// magnetometers by that of the earth, temperatures only if they can be kelvin, times by usual
/// sampling rates, dates, the rate that the file states, the rate of strain and the clock of the
/// machine, strains and stresses by what a test can reach and by the stiffness of ballast. All
/// units, if there is no such source.
PossibleUnits possible_units(const KnownColumn& column, const FileNumbers& numbers,
                             const FileEvidence& evidence);

/// Intervals between successive times of each sensor, in the unit of the file.
std::vector<double> intervals_of(const FileNumbers& numbers);

} // namespace bris
