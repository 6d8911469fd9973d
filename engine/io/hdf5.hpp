#pragma once

#include "engine/io/whole_file.hpp"

#include <concepts>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace bris {

template <class T>
concept Hdf5Number = std::same_as<T, double> || std::same_as<T, float> ||
    std::same_as<T, std::int64_t> || std::same_as<T, std::uint64_t> ||
    std::same_as<T, std::uint32_t> || std::same_as<T, std::uint8_t>;

/// An HDF5 file. Objects are named by their path, as "/VTKHDF/Steps/Values"; missing parent groups
/// are created on writing. Every member throws OutputError with the file, the object and the
/// operation that failed, also for files that are truncated, damaged or not HDF5. After a failure
/// to write, the file stays as the last flush() left it: nothing more is written, and closing it
/// does nothing. Files of users are read with Hdf5Content, since damaged ones crash the library.
/// Different threads may use different files; calls into the library are serialised.
class Hdf5File {
public:
    using Shape = std::vector<std::uint64_t>;

    /// Loads the tables of the library (1 ms), which a child process has then as well.
    static void initialise();
    /// Creates a file, replacing an old one, and its directory if necessary. On other ranks than
    /// the first one, which alone writes (Ranks::writes), there is no file, and what is written
    /// into it is dropped.
    static Hdf5File create(const std::filesystem::path& path);
    static Hdf5File open(const std::filesystem::path& path);          ///< for reading
    static Hdf5File open_to_write(const std::filesystem::path& path); ///< for reading and writing

    Hdf5File(Hdf5File&& other) noexcept;
    Hdf5File& operator=(Hdf5File&& other) noexcept;
    /// Closes the file. An error is lost here, so writers call close().
    ~Hdf5File();
    void close();
    /// False after a failure to write.
    bool is_open() const { return discards_ || (file_ >= 0 && !failed_); }
    void flush(); ///< passes all data to the operating system

    const std::filesystem::path& path() const { return path_; }
    bool has(const std::string& object) const;
    /// Names of the members of a group, sorted.
    std::vector<std::string> names(const std::string& group) const;
    bool is_group(const std::string& object) const; ///< otherwise it is a dataset
    std::vector<std::string> attribute_names(const std::string& object) const;
    void make_group(const std::string& group);
    void remove(const std::string& object);

    /// Writes a new dataset of fixed shape: 1 to 3 dimensions, whose product is the number of
    /// values.
    template <Hdf5Number T>
    void write(const std::string& dataset, std::span<const T> values, const Shape& shape) {
        write(dataset, kind_of<T>(), values.data(), values.size(), shape);
    }
    template <Hdf5Number T>
    void write(const std::string& dataset, std::span<const T> values) {
        write(dataset, values, Shape{values.size()});
    }
    /// Creates a dataset of fixed shape, whose rows are then written, in any order and number of
    /// calls: all of them.
    template <Hdf5Number T>
    void make(const std::string& dataset, const Shape& shape) {
        make(dataset, kind_of<T>(), shape);
    }
    template <Hdf5Number T>
    void write_rows(const std::string& dataset, std::uint64_t first, std::span<const T> values) {
        write_rows(dataset, kind_of<T>(), first, values.data(), values.size());
    }
    /// Creates an empty dataset that grows by rows. `row`: shape of a row (empty: a single number).
    /// `rows_per_chunk`: number of rows that are usually appended at once.
    template <Hdf5Number T>
    void make_growing(const std::string& dataset, const Shape& row, std::uint64_t rows_per_chunk) {
        make_growing(dataset, kind_of<T>(), row, rows_per_chunk);
    }
    /// Appends whole rows to a growing dataset.
    template <Hdf5Number T>
    void append(const std::string& dataset, std::span<const T> values) {
        append(dataset, kind_of<T>(), values.data(), values.size());
    }

    /// All values of a dataset, converted to T if the file stores another type of number.
    template <Hdf5Number T>
    std::vector<T> read(const std::string& dataset) const {
        std::vector<T> values(count(dataset, sizeof(T)));
        read(dataset, kind_of<T>(), values.data());
        return values;
    }
    /// The same into memory for as many values. Throws OutputError if the dataset has another
    /// number.
    template <Hdf5Number T>
    void read_into(const std::string& dataset, std::span<T> values) const {
        require_count(dataset, values.size());
        read(dataset, kind_of<T>(), values.data());
    }
    Shape shape(const std::string& dataset) const; ///< empty: a scalar
    /// Where the values of a dataset of fixed shape are in the file; no bytes if it has no values.
    FileRange range_of(const std::string& dataset) const;

    /// Sets an attribute of a group or dataset, replacing an earlier value.
    template <Hdf5Number T>
    void set_attribute(const std::string& object, const std::string& name, T value) {
        set_attribute(object, name, kind_of<T>(), &value, {});
    }
    template <Hdf5Number T>
    void set_attribute(const std::string& object, const std::string& name,
                       std::span<const T> values) {
        set_attribute(object, name, kind_of<T>(), values.data(), {values.size()});
    }
    void set_attribute(const std::string& object, const std::string& name,
                       const std::string& value);
    bool has_attribute(const std::string& object, const std::string& name) const;
    template <Hdf5Number T>
    std::vector<T> attribute(const std::string& object, const std::string& name) const {
        std::vector<T> values(attribute_count(object, name));
        attribute(object, name, kind_of<T>(), values.data());
        return values;
    }
    std::string text_attribute(const std::string& object, const std::string& name) const;

private:
    enum class Kind { float64, float32, int64, uint64, uint32, uint8 };
    template <Hdf5Number T>
    static constexpr Kind kind_of() {
        if constexpr (std::same_as<T, double>)
            return Kind::float64;
        else if constexpr (std::same_as<T, float>)
            return Kind::float32;
        else if constexpr (std::same_as<T, std::int64_t>)
            return Kind::int64;
        else if constexpr (std::same_as<T, std::uint64_t>)
            return Kind::uint64;
        else if constexpr (std::same_as<T, std::uint32_t>)
            return Kind::uint32;
        else
            return Kind::uint8;
    }
    static std::int64_t type_of(Kind kind); ///< the library's handle

    Hdf5File(std::filesystem::path path, std::int64_t file, bool writes);
    [[noreturn]] void fail(const std::string& doing, const std::string& object) const;
    [[noreturn]] void fail(const std::string& doing, const std::string& object,
                           const std::string& why) const;
    void write(const std::string& dataset, Kind kind, const void* values, std::size_t count,
               const Shape& shape);
    void make(const std::string& dataset, Kind kind, const Shape& shape);
    void write_rows(const std::string& dataset, Kind kind, std::uint64_t first, const void* values,
                    std::size_t count);
    void make_growing(const std::string& dataset, Kind kind, const Shape& row,
                      std::uint64_t rows_per_chunk);
    void append(const std::string& dataset, Kind kind, const void* values, std::size_t count);
    std::size_t count(const std::string& dataset, std::size_t bytes_each) const;
    void require_count(const std::string& dataset, std::size_t values) const;
    void read(const std::string& dataset, Kind kind, void* values) const;
    void set_attribute(const std::string& object, const std::string& name, Kind kind,
                       const void* values, const Shape& shape);
    std::size_t attribute_count(const std::string& object, const std::string& name) const;
    void attribute(const std::string& object, const std::string& name, Kind kind,
                   void* values) const;

    std::filesystem::path path_;
    std::int64_t file_ = -1; ///< the library's handle; negative when closed
    bool writes_ = false, discards_ = false;
    mutable bool failed_ = false; ///< a call has failed on a file that is being written
};

/// A shape as text for messages: "7 x 3", "a scalar".
std::string in_words(const Hdf5File::Shape& shape);

} // namespace bris
