#pragma once

#include "scenarios/library/specimen_library.hpp"
#include "scenarios/records/recorded_test.hpp"

#include <cstddef>
#include <optional>
#include <string>

namespace bris {

/// Why the sensor rocks of a test cannot be compared with those of a library: another number was
/// accepted, or they stand elsewhere. Empty: they can.
std::string reason_against_sensors(const SpecimenLibrary& library, const RecordedTest& test);

/// The recorded displacement (m) of a sensor rock outward, sideways and upward at a strain of a
/// library (`coarse`: its index); none if it was not recorded within a step of the library's
/// strains. The sensor rocks must be comparable.
std::optional<Vec3> recorded_displacement(const SpecimenLibrary& library, const RecordedTest& test,
                                          std::size_t sensor, std::size_t coarse);

} // namespace bris
