// The attributes of groups and datasets.
#include "engine/errors.hpp"
#include "engine/io/hdf5.hpp"
#include "engine/io/hdf5_library.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace bris {

namespace {

/// Writes an attribute, replacing an earlier one of that name; false on failure.
bool put_attribute(hid_t object, const char* name, hid_t type, hid_t space, const void* data) {
    if (H5Aexists(object, name) > 0 && H5Adelete(object, name) < 0) return false;
    const Attribute made(H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT));
    return made >= 0 && H5Awrite(made, type, data) >= 0;
}

std::string attribute_path(const std::string& object, const std::string& name) {
    return fmt::format("attribute {}@{}", object, name);
}

} // namespace

std::vector<std::string> Hdf5File::attribute_names(const std::string& object) const {
    const Alone alone;
    const Object opened(H5Oopen(file_, object.c_str(), H5P_DEFAULT));
    if (opened < 0) fail("open", object);
    std::vector<std::string> list;
    const auto note = [](hid_t, const char* name, const H5A_info_t*, void* target) -> herr_t {
        static_cast<std::vector<std::string>*>(target)->emplace_back(name);
        return 0;
    };
    if (H5Aiterate2(opened, H5_INDEX_NAME, H5_ITER_INC, nullptr, note, &list) < 0)
        fail("list the attributes of", object);
    return list;
}

void Hdf5File::set_attribute(const std::string& object, const std::string& name, Kind kind,
                             const void* values, const Shape& shape) {
    if (discards_) return;
    const Alone alone;
    const Object opened(H5Oopen(file_, object.c_str(), H5P_DEFAULT));
    const auto extent = dimensions(shape);
    const Space space(extent.empty() ? H5Screate(H5S_SCALAR)
                                     : H5Screate_simple(1, extent.data(), nullptr));
    if (opened < 0 || !put_attribute(opened, name.c_str(), type_of(kind), space, values))
        fail("write", attribute_path(object, name));
}

void Hdf5File::set_attribute(const std::string& object, const std::string& name,
                             const std::string& value) {
    if (discards_) return;
    const Alone alone;
    const Object opened(H5Oopen(file_, object.c_str(), H5P_DEFAULT));
    const Space space(H5Screate(H5S_SCALAR));
    const Type type(H5Tcopy(H5T_C_S1)); // fixed length, the only kind that every VTK reader accepts
    H5Tset_size(type, std::max<std::size_t>(value.size(), 1));
    H5Tset_strpad(type, H5T_STR_NULLPAD);
    const bool ascii = std::all_of(value.begin(), value.end(),
                                   [](char c) { return static_cast<unsigned char>(c) < 128; });
    H5Tset_cset(type, ascii ? H5T_CSET_ASCII : H5T_CSET_UTF8);
    if (opened < 0 || !put_attribute(opened, name.c_str(), type, space, value.c_str()))
        fail("write", attribute_path(object, name));
}

bool Hdf5File::has_attribute(const std::string& object, const std::string& name) const {
    const Alone alone;
    if (object != "/" && !has(object)) return false;
    return H5Aexists_by_name(file_, object.c_str(), name.c_str(), H5P_DEFAULT) > 0;
}

std::size_t Hdf5File::attribute_count(const std::string& object, const std::string& name) const {
    const Alone alone;
    const Attribute opened(
        H5Aopen_by_name(file_, object.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT));
    if (opened < 0) fail("read", attribute_path(object, name));
    const hssize_t number = H5Sget_simple_extent_npoints(Space(H5Aget_space(opened)));
    if (number < 0) fail("read", attribute_path(object, name));
    return static_cast<std::size_t>(number);
}

void Hdf5File::attribute(const std::string& object, const std::string& name, Kind kind,
                         void* values) const {
    const Alone alone;
    const Attribute opened(
        H5Aopen_by_name(file_, object.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT));
    if (opened < 0 || H5Aread(opened, type_of(kind), values) < 0)
        fail("read", attribute_path(object, name));
}

std::string Hdf5File::text_attribute(const std::string& object, const std::string& name) const {
    const Alone alone;
    const Attribute opened(
        H5Aopen_by_name(file_, object.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT));
    if (opened < 0) fail("read", attribute_path(object, name));
    const Type stored(H5Aget_type(opened));
    const Space space(H5Aget_space(opened));
    if (H5Tget_class(stored) != H5T_STRING || H5Sget_simple_extent_npoints(space) != 1)
        throw OutputError(fmt::format("cannot read {} in '{}': not a text",
                                      attribute_path(object, name), path_.string()));
    if (H5Tis_variable_str(stored) > 0) {
        char* text = nullptr; // the library's; null: an empty text
        if (H5Aread(opened, stored, &text) < 0) fail("read", attribute_path(object, name));
        const std::string value = text != nullptr ? text : "";
        H5Dvlen_reclaim(stored, space, H5P_DEFAULT, &text);
        return value;
    }
    std::string value(H5Tget_size(stored), '\0');
    if (H5Aread(opened, stored, value.data()) < 0) fail("read", attribute_path(object, name));
    value.resize(std::min(value.find('\0'), value.size()));
    if (H5Tget_strpad(stored) == H5T_STR_SPACEPAD) // as Fortran writes
        value.resize(value.find_last_not_of(' ') + 1);
    return value;
}

} // namespace bris
