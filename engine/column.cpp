#include "engine/column.hpp"

#include "engine/parallel.hpp"

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <new>
#include <sys/mman.h>
#include <utility>

namespace bris {

namespace {

constexpr std::size_t huge_page = std::size_t{1} << 21, page = 4096, line = 64;
constexpr std::size_t bytes_per_chunk = std::size_t{1}
                                        << 17; // of what several threads copy or clear

// A system reads many columns at the same row. Blocks that all begin at the same offset within a
// page would share the few lines of a cache set, and a load would wait for stores to other columns
// whose addresses look like its own. Each block therefore begins at a different offset.
std::size_t next_shift() {
    static std::atomic<std::size_t> count{0};
    const std::size_t k = count++;
    return (k % 16) * page + (k * 37 % 64) * line;
}

/// Makes scratch "not a number" in builds with sanitizers, so that their tests find readers of what
/// nobody has written.
void spoil([[maybe_unused]] std::byte* first, [[maybe_unused]] std::size_t bytes) {
#ifdef BRIS_SANITIZED
    if (bytes > 0) std::memset(first, 0xff, bytes);
#endif
}

/// Bytes that are zero and begin at a huge page; memory that is not touched is not used.
void* map_huge_pages(std::size_t bytes) {
    const std::size_t more = bytes + huge_page - page;
    void* mapped = mmap(nullptr, more, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (mapped == MAP_FAILED) throw std::bad_alloc();
    auto* first = static_cast<std::byte*>(mapped);
    const auto address = reinterpret_cast<std::uintptr_t>(mapped);
    const std::size_t before = (huge_page - address % huge_page) % huge_page,
                      after = more - before - bytes;
    if (before > 0) munmap(first, before);
    if (after > 0) munmap(first + before + bytes, after);
    return first + before;
}

} // namespace

Column::Block::Block(std::size_t bytes, std::size_t used) {
    // huge pages pay from about ten thousand spheres on: up to a third of the step time at 100 000,
    // depending on the processor (tests/performance/peers/switches). A page is huge if at least
    // half of it is used; the last part of a column is then in ordinary pages.
    const std::size_t shift = bytes >= 16 * page ? next_shift() : 0,
                      huge = (used + shift + huge_page / 2) / huge_page * huge_page,
                      unit = huge > 0 ? page : line;
    const std::size_t rounded = std::max((bytes + shift + unit - 1) / unit * unit, huge);
    if (huge > 0) {
        memory = map_huge_pages(rounded);
        mapped = rounded;
        madvise(memory, huge, MADV_HUGEPAGE);
    } else if (memory = std::aligned_alloc(line, rounded); memory == nullptr) {
        throw std::bad_alloc();
    }
    data = static_cast<std::byte*>(memory) + shift;
}

Column::Block& Column::Block::operator=(Block&& other) noexcept {
    std::swap(memory, other.memory);
    std::swap(data, other.data);
    std::swap(mapped, other.mapped);
    return *this;
}

Column::Block::~Block() {
    if (mapped > 0)
        munmap(memory, mapped);
    else
        std::free(memory);
}

Column::Column(const Column& other) : type_(other.type_) {
    resize(other.size_);
    if (size_ > 0) std::memcpy(bytes(), other.bytes(), size_ * type_.value_size);
}

Column::Column(const Column& other, std::span<const Row> rows) : type_(other.type_) {
    resize(rows.size());
    const std::size_t width = type_.value_size;
    for (std::size_t row = 0; type_.is_carried && row < size_; ++row)
        std::memcpy(bytes() + row * width, other.bytes() + rows[row] * width, width);
}

void Column::reserve(std::size_t rows) {
    if (rows <= capacity_) return;
    const std::size_t wanted = rows + rows / 2 + 64;
    Block bigger(wanted * type_.value_size, rows * type_.value_size);
    if (size_ > 0) std::memcpy(bigger.data, bytes(), size_ * type_.value_size);
    capacity_ = wanted;
    use(std::move(bigger));
}

void Column::use(Block block) {
    block_ = std::move(block);
    written_ = block_.mapped > 0 ? size_ : capacity_;
}

void Column::resize(std::size_t rows) {
    reserve(rows);
    std::byte* fresh = bytes() + size_ * type_.value_size;
    const std::size_t end_of_written = std::min(rows, written_);
    if (type_.is_scratch && rows > size_)
        spoil(fresh, (rows - size_) * type_.value_size);
    else if (end_of_written > size_)
        for_chunks((end_of_written - size_) * type_.value_size, bytes_per_chunk,
                   [&](std::size_t, std::size_t first, std::size_t last) {
                       std::memset(fresh + first, 0, last - first);
                   });
    written_ = std::max(written_, rows);
    size_ = rows;
}

void Column::release() {
    block_ = Block();
    size_ = capacity_ = written_ = 0;
}

void Column::keep(std::span<const Row> rows) {
    const std::size_t width = type_.value_size, before = size_;
    size_ = rows.size();
    if (type_.is_scratch) return spoil(bytes(), size_ * width);
    const bool removes_few =
        2 * size_ >= before && std::ranges::adjacent_find(rows, std::greater_equal()) == rows.end();
    if (removes_few) { // then no other memory is needed
        for (std::size_t row = 0; row < size_; ++row)
            std::memmove(bytes() + row * width, bytes() + rows[row] * width, width);
        return;
    }
    Block moved(capacity_ * width, before * width); // as many rows are likely to follow
    for_chunks(size_, std::max<std::size_t>(bytes_per_chunk / width, 1),
               [&](std::size_t, std::size_t first, std::size_t last) {
                   for (std::size_t row = first; row < last; ++row)
                       std::memcpy(moved.data + row * width, bytes() + rows[row] * width, width);
               });
    use(std::move(moved));
}

} // namespace bris
