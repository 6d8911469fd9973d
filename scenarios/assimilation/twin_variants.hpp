#pragma once

#include <string>
#include <vector>

namespace bris {

/// The variants of the model in a list of names separated by commas; none for "none", where only
/// the truth is run. Throws InputError on an unknown name and on one that occurs twice.
std::vector<std::string> names_of_variants(const std::string& list);

/// Whether a variant is computed from the ensemble members, without a run of its own.
bool is_computed(const std::string& variant);

/// Whether a variant is corrected by the recordings of the sensors.
bool is_corrected(const std::string& variant);

/// Whether a variant has parameters that ensemble members have learned.
bool learns(const std::string& variant);

} // namespace bris
