#include "engine/column.hpp"

#include <sys/mman.h>

#include <cstdlib>
#include <cstring>
#include <new>

namespace bris {

namespace {

constexpr std::size_t huge_page = std::size_t{1} << 21;

std::byte* allocate(std::size_t bytes) {
    // huge pages pay from about 100 000 spheres on: a third of the step there
    const bool large = bytes >= 2 * huge_page;
    const std::size_t alignment = large ? huge_page : 64;
    const std::size_t rounded = (bytes + alignment - 1) / alignment * alignment;
    void* memory = std::aligned_alloc(alignment, rounded);
    if (memory == nullptr) throw std::bad_alloc();
    if (large) madvise(memory, rounded, MADV_HUGEPAGE);
    return static_cast<std::byte*>(memory);
}

} // namespace

Column::Column(const Column& other) : type_(other.type_) {
    resize(other.size_);
    if (size_ > 0) std::memcpy(data_, other.data_, size_ * type_.value_size);
}

Column::~Column() { std::free(data_); }

void Column::reserve(std::size_t rows) {
    if (rows <= capacity_) return;
    const std::size_t wanted = rows + rows / 2 + 64;
    std::byte* bigger = allocate(wanted * type_.value_size);
    if (size_ > 0) std::memcpy(bigger, data_, size_ * type_.value_size);
    std::free(data_);
    data_ = bigger;
    capacity_ = wanted;
}

void Column::resize(std::size_t rows) {
    reserve(rows);
    if (rows > size_)
        std::memset(data_ + size_ * type_.value_size, 0, (rows - size_) * type_.value_size);
    size_ = rows;
}

void Column::permute(std::span<const Row> new_to_old) {
    const std::size_t width = type_.value_size;
    std::byte* moved = allocate(capacity_ * width);
    for (std::size_t row = 0; row < size_; ++row)
        std::memcpy(moved + row * width, data_ + new_to_old[row] * width, width);
    std::free(data_);
    data_ = moved;
}

} // namespace bris
