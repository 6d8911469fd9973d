#include "engine/io/hdf5.hpp"

#include "engine/errors.hpp"
#include "engine/io/hdf5_library.hpp"
#include "engine/ranks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <fcntl.h>
#include <numeric>
#include <stdexcept>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#include <utility>

namespace bris {

namespace {

constexpr std::size_t most_bytes = std::size_t{1} << 38; // 256 GiB in one dataset

/// Description of the innermost error of the failed call.
std::string reason() {
    std::string text;
    const auto note = [](unsigned, const H5E_error2_t* error, void* target) -> herr_t {
        auto& out = *static_cast<std::string*>(target);
        if (out.empty() && error->desc) out = error->desc;
        return 0;
    };
    H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, note, &text);
    H5Eclear2(H5E_DEFAULT);
    // shortens "unable to open file: name = '...', errno = 2, error message = '...', flags = ..."
    if (const auto at = text.find("error message = '"); at != std::string::npos)
        text = text.substr(at + 17, text.find('\'', at + 17) - at - 17);
    return text.empty() ? "unknown reason" : text;
}

/// The descriptor of an open file; negative: unknown.
int descriptor_of(hid_t file) {
    void* descriptor = nullptr;
    const bool known =
        H5Fget_vfd_handle(file, H5P_DEFAULT, &descriptor) >= 0 && descriptor != nullptr;
    return known ? *static_cast<int*>(descriptor) : -1;
}

/// The library locks a file that is being written exclusively. With a shared lock, others may read
/// what was flushed, and nobody else can write. This is best effort: a reader may find a
/// half-written file during a flush and must read it again, and if the lock is not available at
/// once, or locks do not exist, everything stays as it is.
void let_others_read(hid_t file) {
    if (const int descriptor = descriptor_of(file); descriptor >= 0)
        (void)flock(descriptor, LOCK_SH | LOCK_NB);
}

/// Takes the space on the disk that a file will need, before a flush: a flush that fails halfway
/// destroys what is complete, and a file that is shorter than its head says, because the process
/// was killed in the middle, cannot be opened at all. Returns 0 or the number of the error.
int reserve(hid_t file) {
    const int descriptor = descriptor_of(file);
    haddr_t end = 0;
    struct stat status {};
    if (descriptor < 0 || H5Fget_eoa(file, &end) < 0 || fstat(descriptor, &status) != 0) return 0;
    const auto size = static_cast<haddr_t>(status.st_size);
    return size >= end
               ? 0
               : posix_fallocate(descriptor, status.st_size, static_cast<off_t>(end - size));
}

/// Removes what `reserve` took beyond the end of a closed file, which its head states.
/// `descriptor`: of the file; it is closed.
void cut_to_size(int descriptor) {
    std::array<std::uint8_t, 48> head{};
    constexpr std::size_t version_at = 8, width_at = 13, end_at = 40; // of the format's version 0
    const bool is_read = pread(descriptor, head.data(), head.size(), 0) == ssize_t{head.size()};
    std::uint64_t end = 0;
    std::memcpy(&end, head.data() + end_at, sizeof end);
    struct stat status {};
    if (is_read && head[version_at] == 0 && head[width_at] == sizeof end &&
        fstat(descriptor, &status) == 0 && static_cast<std::uint64_t>(status.st_size) > end)
        (void)!ftruncate(descriptor, static_cast<off_t>(end)); // without it nothing is wrong
    ::close(descriptor);
}

std::vector<hsize_t> extents(hid_t space) {
    const int rank = H5Sget_simple_extent_ndims(space);
    std::vector<hsize_t> extent(rank > 0 ? static_cast<std::size_t>(rank) : 0);
    if (rank > 0) H5Sget_simple_extent_dims(space, extent.data(), nullptr);
    return extent;
}

/// Number of values in rows of this shape.
hsize_t product(const std::vector<hsize_t>& extent, std::size_t from = 0) {
    return std::accumulate(extent.begin() + static_cast<std::ptrdiff_t>(from), extent.end(),
                           hsize_t{1}, std::multiplies<>{});
}

/// Property list that creates intermediate groups on the way to an object.
hid_t with_parents() {
    const hid_t list = H5Pcreate(H5P_LINK_CREATE);
    H5Pset_create_intermediate_group(list, 1);
    return list;
}

/// The same values give the same bytes at any time of the day.
hid_t without_times() {
    const hid_t list = H5Pcreate(H5P_DATASET_CREATE);
    H5Pset_obj_track_times(list, 0);
    return list;
}

/// The library keeps metadata in memory, by itself up to 32 MB of each file's, for which it takes
/// ten times as much memory. A file that grows for days would take all that, so little is kept.
hid_t with_small_cache() {
    const hid_t list = H5Pcreate(H5P_FILE_ACCESS);
    H5AC_cache_config_t cache{};
    cache.version = H5AC__CURR_CACHE_CONFIG_VERSION;
    H5Pget_mdc_config(list, &cache);
    cache.set_initial_size = true;
    cache.initial_size = cache.max_size = cache.min_size = std::size_t{1} << 17;
    cache.incr_mode = H5C_incr__off;
    cache.flash_incr_mode = H5C_flash_incr__off;
    cache.decr_mode = H5C_decr__off;
    H5Pset_mdc_config(list, &cache);
    return list;
}

} // namespace

Hdf5File::Hdf5File(std::filesystem::path path, std::int64_t file, bool writes)
    : path_(std::move(path)), file_(file), writes_(writes) {}

Hdf5File::Hdf5File(Hdf5File&& other) noexcept
    : path_(std::move(other.path_)), file_(std::exchange(other.file_, -1)), writes_(other.writes_),
      discards_(other.discards_), failed_(other.failed_) {}

Hdf5File& Hdf5File::operator=(Hdf5File&& other) noexcept {
    std::swap(path_, other.path_);
    std::swap(file_, other.file_);
    std::swap(writes_, other.writes_);
    std::swap(discards_, other.discards_);
    std::swap(failed_, other.failed_);
    return *this;
}

Hdf5File::~Hdf5File() {
    const Alone alone;
    // To close a file is to write what is in the buffers of the library: after a failure this would
    // destroy what is complete. The file then stays open until the process ends.
    if (is_open() && !discards_) H5Fclose(file_);
}

void Hdf5File::fail(const std::string& doing, const std::string& object) const {
    fail(doing, object, reason());
}

void Hdf5File::fail(const std::string& doing, const std::string& object,
                    const std::string& why) const {
    failed_ = writes_;
    throw OutputError(object.empty() ? fmt::format("cannot {} '{}': {}", doing, path_.string(), why)
                                     : fmt::format("cannot {} {} in '{}': {}", doing, object,
                                                   path_.string(), why));
}

void Hdf5File::initialise() {
    const Alone alone;
    H5open();
}

Hdf5File Hdf5File::create(const std::filesystem::path& name) {
    if (!Ranks::writes()) {
        Hdf5File nothing(name, -1, true);
        nothing.discards_ = true;
        return nothing;
    }
    const std::filesystem::path path = file_to_write(name);
    const Alone alone;
    std::error_code error;
    if (path.has_parent_path()) std::filesystem::create_directories(path.parent_path(), error);
    const Properties access(with_small_cache());
    Hdf5File file(path, H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access), true);
    if (file.file_ < 0) file.fail("create", "");
    let_others_read(file.file_);
    return file;
}

Hdf5File Hdf5File::open(const std::filesystem::path& path) {
    require_regular_file(path);
    const Alone alone;
    Hdf5File file(path, H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), false);
    if (file.file_ < 0) file.fail("open", "");
    return file;
}

Hdf5File Hdf5File::open_to_write(const std::filesystem::path& path) {
    require_regular_file(path);
    const Alone alone;
    const Properties access(with_small_cache());
    Hdf5File file(path, H5Fopen(path.c_str(), H5F_ACC_RDWR, access), true);
    if (file.file_ < 0) file.fail("open", "");
    return file;
}

void Hdf5File::close() {
    const Alone alone;
    if (!is_open()) return;
    flush();
    if (std::exchange(discards_, false)) return;
    const int descriptor = writes_ ? dup(descriptor_of(file_)) : -1;
    const bool closed = H5Fclose(std::exchange(file_, -1)) >= 0;
    if (descriptor >= 0) cut_to_size(descriptor);
    if (!closed) fail("close", "");
}

void Hdf5File::flush() {
    if (writes_ && !Ranks::writes()) return;
    const Alone alone;
    if (const int error = reserve(file_); error != 0) fail("write", "", std::strerror(error));
    if (H5Fflush(file_, H5F_SCOPE_GLOBAL) >= 0) return;
    const std::string why = reason();
    H5Fflush(file_, H5F_SCOPE_GLOBAL); // what was complete is lost unless the flush is completed
    fail("write", "", why);
}

bool Hdf5File::has(const std::string& object) const {
    const Alone alone;
    // every link on the way must exist, otherwise the library reports an error
    for (std::size_t end = object.find('/', 1);; end = object.find('/', end + 1)) {
        const std::string prefix = object.substr(0, end);
        if (prefix != "/" && H5Lexists(file_, prefix.c_str(), H5P_DEFAULT) <= 0) return false;
        if (end == std::string::npos) return true;
    }
}

std::vector<std::string> Hdf5File::names(const std::string& group) const {
    const Alone alone;
    const Group opened(H5Gopen2(file_, group.c_str(), H5P_DEFAULT));
    if (opened < 0) fail("open", group);
    std::vector<std::string> list;
    const auto note = [](hid_t, const char* name, const H5L_info_t*, void* target) -> herr_t {
        static_cast<std::vector<std::string>*>(target)->emplace_back(name);
        return 0;
    };
    if (H5Literate(opened, H5_INDEX_NAME, H5_ITER_INC, nullptr, note, &list) < 0)
        fail("list", group);
    return list;
}

bool Hdf5File::is_group(const std::string& object) const {
    const Alone alone;
    const Object opened(H5Oopen(file_, object.c_str(), H5P_DEFAULT));
    if (opened < 0) fail("open", object);
    return H5Iget_type(opened) == H5I_GROUP;
}

void Hdf5File::make_group(const std::string& group) {
    if (discards_) return;
    const Alone alone;
    if (group == "/" || has(group)) return;
    const Properties parents(with_parents());
    const Group made(H5Gcreate2(file_, group.c_str(), parents, H5P_DEFAULT, H5P_DEFAULT));
    if (made < 0) fail("create", group);
}

void Hdf5File::remove(const std::string& object) {
    if (discards_) return;
    const Alone alone;
    if (H5Ldelete(file_, object.c_str(), H5P_DEFAULT) < 0) fail("remove", object);
}

std::int64_t Hdf5File::type_of(Kind kind) {
    switch (kind) {
    case Kind::float64:
        return H5T_NATIVE_DOUBLE;
    case Kind::float32:
        return H5T_NATIVE_FLOAT;
    case Kind::int64:
        return H5T_NATIVE_INT64;
    case Kind::uint64:
        return H5T_NATIVE_UINT64;
    case Kind::uint32:
        return H5T_NATIVE_UINT32;
    default:
        return H5T_NATIVE_UINT8;
    }
}

namespace {

/// Number of rows that some values are.
hsize_t rows_in(const std::string& dataset, const std::vector<hsize_t>& extent,
                std::size_t number) {
    const hsize_t per_row = extent.empty() ? 0 : product(extent, 1);
    if (per_row == 0 || number % per_row != 0)
        throw std::logic_error(
            fmt::format("{}: {} values in rows of {}", dataset, number, per_row));
    return number / per_row;
}

bool put_rows(hid_t dataset, hid_t type, hsize_t first, hsize_t rows,
              const std::vector<hsize_t>& extent, const void* values) {
    std::vector<hsize_t> start(extent.size(), 0), block = extent;
    start[0] = first;
    block[0] = rows;
    const Space target(H5Dget_space(dataset));
    H5Sselect_hyperslab(target, H5S_SELECT_SET, start.data(), nullptr, block.data(), nullptr);
    const Space source(H5Screate_simple(static_cast<int>(block.size()), block.data(), nullptr));
    return H5Dwrite(dataset, type, source, target, H5P_DEFAULT, values) >= 0;
}

} // namespace

void Hdf5File::write(const std::string& dataset, Kind kind, const void* values, std::size_t count,
                     const Shape& shape) {
    if (discards_) return;
    const Alone alone;
    const auto extent = dimensions(shape);
    if (product(extent) != count)
        throw std::logic_error(
            fmt::format("{}: {} values for a shape of {}", dataset, count, product(extent)));
    const Space space(H5Screate_simple(static_cast<int>(extent.size()), extent.data(), nullptr));
    const Properties parents(with_parents()), creation(without_times());
    Dataset made(
        H5Dcreate2(file_, dataset.c_str(), type_of(kind), space, parents, creation, H5P_DEFAULT));
    if (made < 0 || H5Dwrite(made, type_of(kind), H5S_ALL, H5S_ALL, H5P_DEFAULT, values) < 0 ||
        !made.closed_well())
        fail("write", dataset);
}

void Hdf5File::make_growing(const std::string& dataset, Kind kind, const Shape& row,
                            std::uint64_t rows_per_chunk) {
    if (discards_) return;
    const Alone alone;
    std::vector<hsize_t> extent{0}, most{H5S_UNLIMITED};
    std::vector<hsize_t> chunk{std::max<hsize_t>(rows_per_chunk, 1)};
    for (const std::uint64_t n : row) {
        extent.push_back(n);
        most.push_back(n);
        chunk.push_back(n);
    }
    const int rank = static_cast<int>(extent.size());
    const Space space(H5Screate_simple(rank, extent.data(), most.data()));
    const Properties parents(with_parents()), creation(without_times());
    H5Pset_chunk(creation, rank, chunk.data());
    const Dataset made(
        H5Dcreate2(file_, dataset.c_str(), type_of(kind), space, parents, creation, H5P_DEFAULT));
    if (made < 0) fail("create", dataset);
}

void Hdf5File::make(const std::string& dataset, Kind kind, const Shape& shape) {
    if (discards_) return;
    const Alone alone;
    const auto extent = dimensions(shape);
    const Space space(H5Screate_simple(static_cast<int>(extent.size()), extent.data(), nullptr));
    const Properties parents(with_parents()), creation(without_times());
    // its place in the file does not depend on the order in which rows are written
    H5Pset_alloc_time(creation, H5D_ALLOC_TIME_EARLY);
    H5Pset_fill_time(creation, H5D_FILL_TIME_NEVER);
    Dataset made(
        H5Dcreate2(file_, dataset.c_str(), type_of(kind), space, parents, creation, H5P_DEFAULT));
    if (made < 0 || !made.closed_well()) fail("create", dataset);
}

void Hdf5File::write_rows(const std::string& dataset, Kind kind, std::uint64_t first,
                          const void* values, std::size_t number) {
    if (discards_) return;
    const Alone alone;
    Dataset opened(H5Dopen2(file_, dataset.c_str(), H5P_DEFAULT));
    if (opened < 0) fail("open", dataset);
    const auto extent = extents(Space(H5Dget_space(opened)));
    const hsize_t rows = rows_in(dataset, extent, number);
    if (rows == 0) return;
    if (first + rows > extent[0])
        throw std::logic_error(
            fmt::format("{}: {} rows from {} on of {}", dataset, rows, first, extent[0]));
    if (!put_rows(opened, type_of(kind), first, rows, extent, values) || !opened.closed_well())
        fail("write", dataset);
}

void Hdf5File::append(const std::string& dataset, Kind kind, const void* values,
                      std::size_t number) {
    if (discards_) return;
    const Alone alone;
    Dataset opened(H5Dopen2(file_, dataset.c_str(), H5P_DEFAULT));
    if (opened < 0) fail("open", dataset);
    auto extent = extents(Space(H5Dget_space(opened)));
    const hsize_t rows = rows_in(dataset, extent, number), first = extent.front();
    if (rows == 0) return;
    extent[0] += rows;
    if (H5Dset_extent(opened, extent.data()) < 0) fail("extend", dataset);
    if (!put_rows(opened, type_of(kind), first, rows, extent, values) || !opened.closed_well())
        fail("write", dataset);
}

std::size_t Hdf5File::count(const std::string& dataset, std::size_t bytes_each) const {
    const Alone alone;
    const Dataset opened(H5Dopen2(file_, dataset.c_str(), H5P_DEFAULT));
    if (opened < 0) fail("open", dataset);
    const hssize_t number = H5Sget_simple_extent_npoints(Space(H5Dget_space(opened)));
    if (number < 0) fail("read", dataset);
    // a damaged file may claim any size; a message is better than a failed allocation
    if (static_cast<std::size_t>(number) > most_bytes / bytes_each)
        throw OutputError(
            fmt::format("cannot read {} in '{}': {} values are more than any run writes", dataset,
                        path_.string(), number));
    return static_cast<std::size_t>(number);
}

void Hdf5File::read(const std::string& dataset, Kind kind, void* values) const {
    const Alone alone;
    const Dataset opened(H5Dopen2(file_, dataset.c_str(), H5P_DEFAULT));
    if (opened < 0) fail("open", dataset);
    if (H5Sget_simple_extent_npoints(Space(H5Dget_space(opened))) == 0) return;
    if (H5Dread(opened, type_of(kind), H5S_ALL, H5S_ALL, H5P_DEFAULT, values) < 0)
        fail("read", dataset);
}

void Hdf5File::require_count(const std::string& dataset, std::size_t values) const {
    if (const std::size_t found = count(dataset, 1); found != values)
        throw OutputError(fmt::format("cannot read {} in '{}': expected {} values, found {}",
                                      dataset, path_.string(), values, found));
}

FileRange Hdf5File::range_of(const std::string& dataset) const {
    const Alone alone;
    const Dataset opened(H5Dopen2(file_, dataset.c_str(), H5P_DEFAULT));
    if (opened < 0) fail("open", dataset);
    const haddr_t first = H5Dget_offset(opened);
    return first == HADDR_UNDEF ? FileRange{} : FileRange{first, H5Dget_storage_size(opened)};
}

Hdf5File::Shape Hdf5File::shape(const std::string& dataset) const {
    const Alone alone;
    const Dataset opened(H5Dopen2(file_, dataset.c_str(), H5P_DEFAULT));
    if (opened < 0) fail("open", dataset);
    const auto extent = extents(Space(H5Dget_space(opened)));
    return {extent.begin(), extent.end()};
}

std::string in_words(const Hdf5File::Shape& shape) {
    std::string text;
    for (const std::uint64_t extent : shape)
        text += fmt::format("{}{}", text.empty() ? "" : " x ", extent);
    return text.empty() ? "a scalar" : text;
}

} // namespace bris
