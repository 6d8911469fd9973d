#pragma once

#include "engine/entity.hpp"
#include "engine/parallel.hpp"

#include <vector>

namespace bris::detail {

/// Lists of unknown length that chunks of rows fill in parallel and that are then concatenated. The
/// result does not depend on the number of threads.
template <class T>
class ChunkLists {
public:
    static constexpr std::size_t rows_per_chunk = 128;

    /// Calls body(list, row) for each row; the rows of a chunk append in order to the chunk's own
    /// list. `first[row]` becomes the index of the row's first entry; first[n] is the total.
    template <class Body>
    void collect(std::size_t n, std::vector<Row>& first, Body&& body) {
        lists_.resize((n + rows_per_chunk - 1) / rows_per_chunk);
        first.resize(n + 1);
        for_chunks(n, rows_per_chunk, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
            auto& list = lists_[chunk];
            list.clear();
            for (std::size_t row = begin; row < end; ++row) {
                first[row] = static_cast<Row>(list.size());
                body(list, static_cast<Row>(row));
            }
        });
        starts_.resize(lists_.size());
        std::size_t total = 0;
        for (std::size_t chunk = 0; chunk < lists_.size(); ++chunk) {
            starts_[chunk] = total;
            total += lists_[chunk].size();
        }
        for_chunks(n, rows_per_chunk, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
            for (std::size_t row = begin; row < end; ++row)
                first[row] += static_cast<Row>(starts_[chunk]);
        });
        first[n] = static_cast<Row>(total);
    }
    std::size_t size() const { return starts_.empty() ? 0 : starts_.back() + lists_.back().size(); }
    /// Calls body(index, entry) for every entry, in parallel.
    template <class Body>
    void lay_out(Body&& body) const {
        for_chunks(lists_.size(), 1, [&](std::size_t chunk, std::size_t, std::size_t) {
            std::size_t index = starts_[chunk];
            for (const T& entry : lists_[chunk]) body(index++, entry);
        });
    }

private:
    std::vector<std::vector<T>> lists_;
    std::vector<std::size_t> starts_;
};

} // namespace bris::detail
