#include "tests/engine/io/foreign_text.hpp"

#include <hdf5.h>

#include <stdexcept>

namespace bris::testing {

void set_foreign_text(const std::filesystem::path& path, const std::string& object,
                      const std::string& attribute, const std::string& text, ForeignText kind) {
    const bool is_variable = kind == ForeignText::variable;
    const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT),
                owner = H5Oopen(file, object.c_str(), H5P_DEFAULT), type = H5Tcopy(H5T_C_S1),
                space = H5Screate(H5S_SCALAR);
    const std::string padded = text + "  ";
    H5Tset_size(type, is_variable ? H5T_VARIABLE : padded.size());
    H5Tset_strpad(type, is_variable ? H5T_STR_NULLTERM : H5T_STR_SPACEPAD);
    H5Tset_cset(type, H5T_CSET_UTF8);
    const hid_t made = H5Acreate2(owner, attribute.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT);
    const char* const pointer = text.c_str();
    const void* const data = is_variable ? static_cast<const void*>(&pointer) : padded.c_str();
    const bool is_written = made >= 0 && H5Awrite(made, type, data) >= 0;
    H5Aclose(made);
    H5Sclose(space);
    H5Tclose(type);
    H5Oclose(owner);
    H5Fclose(file);
    if (!is_written) throw std::runtime_error("cannot write " + attribute);
}

} // namespace bris::testing
