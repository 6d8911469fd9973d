#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace bris {

/// The variants of the model that a twin experiment compares (see --variants).
enum class TwinVariant : std::uint8_t { free, inserted, nudged, analysis };
const std::vector<std::string>& texts_of(TwinVariant);

/// The variants in a list of texts separated by commas; none for "none", where only the truth is
/// run. Throws InputError on an unknown text and on one that occurs twice.
std::vector<TwinVariant> variants_in(const std::string& list);

/// Whether a variant is computed from the ensemble members, without a run of its own.
inline bool is_computed(TwinVariant variant) { return variant == TwinVariant::analysis; }

} // namespace bris
