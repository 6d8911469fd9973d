#pragma once

#include <string>
#include <vector>

namespace bris {

/// The variants of the model in a list of names separated by commas; none for "none", where only
/// the truth is run. Throws InputError on an unknown name and on one that occurs twice.
std::vector<std::string> names_of_variants(const std::string& list);

/// Whether a variant is computed from the ensemble members, without a run of its own.
inline bool is_computed(const std::string& variant) { return variant == "analysis"; }

} // namespace bris
