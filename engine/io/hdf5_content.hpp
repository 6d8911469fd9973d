#pragma once

#include "engine/io/hdf5.hpp"

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace bris {

/// Groups of an HDF5 file that a user gave, as plain arrays. The library crashes on some damaged
/// files and lets others take gigabytes, so a child process reads the file, with ten times its size
/// and 64 MiB of memory and a second of processor time (one more for each 20 MB). Members are
/// called like those of Hdf5File, and throw OutputError like these.
class Hdf5Content {
public:
    enum class Datasets { left_out, included };

    /// Reads these groups, and what is in them down to a depth of two, with all attributes. A group
    /// that is missing is left out. Throws OutputError with the reason if the file cannot be read.
    static Hdf5Content read(const std::filesystem::path& path,
                            const std::vector<std::string>& groups,
                            Datasets datasets = Datasets::included);

    const std::filesystem::path& path() const { return path_; }
    bool has(const std::string& object) const { return entries_.contains(object); }
    std::vector<std::string> names(const std::string& group) const; ///< of the members, sorted
    const Hdf5File::Shape& shape(const std::string& dataset) const;
    /// All numbers of a dataset, whose type in the file may be any type of number.
    const std::vector<double>& numbers(const std::string& dataset) const;
    std::vector<std::string> attribute_names(const std::string& object) const; ///< sorted
    bool has_attribute(const std::string& object, const std::string& name) const;
    bool has_text(const std::string& object, const std::string& attribute) const;
    const std::vector<double>& attribute(const std::string& object, const std::string& name) const;
    const std::string& text_attribute(const std::string& object, const std::string& name) const;

    /// What the child passes on of an object or an attribute ("/group@name").
    struct Entry {
        Hdf5File::Shape shape = {};
        std::vector<double> numbers = {};
        std::string text = {};       ///< of an attribute
        std::string no_numbers = {}; ///< why there are none; empty: there are
        std::string no_text = {};    ///< the same
    };

private:
    const Entry& entry(const std::string& name) const;

    std::filesystem::path path_;
    std::map<std::string, Entry> entries_;
};

} // namespace bris
