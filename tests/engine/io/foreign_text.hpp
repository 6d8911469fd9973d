#pragma once

#include <filesystem>
#include <string>

namespace bris::testing {

/// Adds a text to an object of an HDF5 file as other programs write texts: of variable length
/// (h5py, xarray, MATLAB, HDF5.jl), or padded with blanks (Fortran).
enum class ForeignText { variable, padded };
void set_foreign_text(const std::filesystem::path& file, const std::string& object,
                      const std::string& attribute, const std::string& text, ForeignText kind);

} // namespace bris::testing
