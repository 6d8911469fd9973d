#include "engine/state_of_world.hpp"

#include "engine/ordering.hpp"
#include "engine/ranks.hpp"

#include <algorithm>
#include <cstring>
#include <limits>
#include <optional>
#include <span>
#include <utility>

namespace bris {

const Column* key_of_state(const Table& table) {
    const Column* key = nullptr;
    bool holds_more = false;
    for (const auto& column : table.columns()) {
        if (column->type().is_key)
            key = column.get();
        else
            holds_more = holds_more || column->type().is_state;
    }
    return holds_more ? key : nullptr;
}

std::string path_in_state(const Table& table, const Column& column) {
    return table.name() + "/" + column.type().name;
}

namespace {

bool key_less(const Column& key, Row a, Row b) {
    const std::size_t width = key.type().value_size, numbers = width / sizeof(std::uint32_t);
    const auto* base = reinterpret_cast<const std::uint32_t*>(key.bytes());
    return std::lexicographical_compare(base + a * numbers, base + (a + 1) * numbers,
                                        base + b * numbers, base + (b + 1) * numbers);
}

std::uint32_t first_number(const Column& key, Row row) {
    std::uint32_t number = 0;
    std::memcpy(&number, key.bytes() + row * key.type().value_size, sizeof number);
    return number;
}

/// Of these rows those that are saved, in the order of the key.
std::vector<Row> rows_to_save(const Table& table, const Column& key, std::vector<Row> rows) {
    // a row is left out only if none of its sparse columns has content
    std::vector<const Column*> sparse;
    for (const auto& column : table.columns())
        if (column->type().keep != nullptr) sparse.push_back(column.get());
    if (!sparse.empty())
        std::erase_if(rows, [&](Row r) {
            return std::ranges::none_of(sparse, [r](const Column* c) {
                return c->type().keep(c->bytes() + r * c->type().value_size);
            });
        });
    const auto less = [&](Row a, Row b) { return key_less(key, a, b); };
    if (!std::is_sorted(rows.begin(), rows.end(), less)) std::sort(rows.begin(), rows.end(), less);
    return rows;
}

/// The State columns of a table, as arrays without rows.
std::vector<Archive::Array> arrays_of(const Table& table, const Column& key) {
    std::vector<Archive::Array> arrays;
    for (const auto& column : table.columns())
        if (const auto& type = column->type(); type.is_state)
            arrays.push_back({path_in_state(table, *column),
                              type.scalar,
                              type.scalar_size,
                              type.value_size / type.scalar_size,
                              {},
                              path_in_state(table, key)});
    return arrays;
}

/// Appends the values of rows to arrays, column by column.
void append(const Table& table, std::span<const Row> rows, std::vector<Archive::Array>& arrays) {
    auto array = arrays.begin();
    for (const auto& column : table.columns()) {
        const auto& type = column->type();
        if (!type.is_state) continue;
        std::vector<std::byte>& bytes = array++->bytes;
        std::size_t at = bytes.size();
        bytes.resize(at + rows.size() * type.value_size);
        for (const Row row : rows) {
            std::memcpy(bytes.data() + at, column->bytes() + row * type.value_size,
                        type.value_size);
            at += type.value_size;
        }
    }
}

/// Brings the rows of all arrays into the order of the ids, of which no two ranks have the same.
void sort_rows(std::vector<Archive::Array>& arrays) {
    const auto& key = *std::ranges::find_if(
        arrays, [](const Archive::Array& array) { return array.path == array.key; });
    std::vector<std::uint32_t> id(key.rows());
    for (std::size_t k = 0; k < id.size(); ++k)
        std::memcpy(&id[k], key.bytes.data() + k * key.width(), sizeof id[k]);
    if (std::ranges::is_sorted(id)) return;
    std::vector<Row> order = all_rows(id.size());
    std::ranges::stable_sort(order, {}, [&](Row k) { return id[k]; });
    for (Archive::Array& array : arrays) {
        std::vector<std::byte> sorted(array.bytes.size());
        for (std::size_t k = 0; k < order.size(); ++k)
            std::memcpy(sorted.data() + k * array.width(),
                        array.bytes.data() + order[k] * array.width(), array.width());
        array.bytes = std::move(sorted);
    }
}

/// Gives the first rank the rows of all, in the order of the ids.
void gather(std::vector<Archive::Array>& arrays) {
    for (Archive::Array& array : arrays) Ranks::gather(array.bytes);
    sort_rows(arrays);
}

std::vector<StatePiece::Rows> rows_of(const std::vector<Archive::Array>& arrays) {
    std::vector<StatePiece::Rows> rows;
    for (const Archive::Array& array : arrays) rows.push_back({&array, array.bytes});
    return rows;
}

/// The rows that this rank gives of a table, in pieces.
class PiecesOfTable {
public:
    PiecesOfTable(const Table& table, const Column& key, std::vector<Row> rows, bool is_divided)
        : table_(table), key_(key), rows_(std::move(rows)), is_divided_(is_divided) {}

    void visit(const StateSource::Visit& visit) const {
        const std::vector<Archive::Array> layout = arrays_of(table_, key_);
        StatePiece piece;
        piece.rows_of_table = number_of_rows();
        std::size_t next = 0;
        // a table without rows has one piece, for its shape
        for (auto ids = next_ids(next); ids || piece.arrays.empty(); ids = next_ids(next)) {
            std::size_t end = next;
            while (end < rows_.size() && ids_at(end) == *ids) ++end;
            std::vector<Archive::Array> arrays = layout;
            append(table_, std::span(rows_).subspan(next, end - next), arrays);
            next = end;
            if (is_divided_) gather(arrays);
            piece.ids = ids.value_or(0);
            piece.arrays = rows_of(arrays);
            if (!is_divided_ || Ranks::is_first()) visit(piece);
            piece.first_row += arrays.front().rows();
            if (is_divided_) wait_for_writer();
        }
    }

private:
    std::size_t number_of_rows() const {
        auto sum = static_cast<std::int64_t>(rows_.size());
        if (is_divided_) Ranks::sum({&sum, 1});
        return static_cast<std::size_t>(sum);
    }
    std::uint32_t ids_at(std::size_t k) const {
        return first_number(key_, rows_[k]) / ids_per_block;
    }
    /// The block of ids of the next row of any rank.
    std::optional<std::uint32_t> next_ids(std::size_t next) const {
        constexpr double none = std::numeric_limits<std::uint32_t>::max();
        double least = next < rows_.size() ? ids_at(next) : none;
        if (is_divided_) least = -Ranks::largest(-least);
        if (least == none) return {};
        return static_cast<std::uint32_t>(least);
    }
    /// The first rank may have written what it got to a slow disk.
    static void wait_for_writer() {
        (void)Ranks::writes();
        Ranks::meet();
    }

    const Table& table_;
    const Column& key_;
    std::vector<Row> rows_;
    bool is_divided_;
};

} // namespace

void StateOfWorld::for_pieces(const Visit& visit) const {
    if (!visit && rows_of_ == nullptr) return;
    for (const auto& named : part_.tables()) {
        const Table& table = *named.table;
        const Column* key = key_of_state(table);
        if (key == nullptr) continue;
        auto rows = rows_of_ != nullptr ? rows_of_(part_, table) : all_rows(table.size());
        PiecesOfTable(table, *key, rows_to_save(table, *key, std::move(rows)), rows_of_ != nullptr)
            .visit(visit);
    }
    if (rows_of_ != nullptr && !Ranks::is_first()) return;
    Archive resources;
    for (const auto& held : whole_.resources())
        (held->changes_in_whole_steps_only ? held.get() : part_.find_resource(held->type))
            ->save(resources);
    bris::for_pieces(resources, [&](std::size_t, const StatePiece& piece) { visit(piece); });
}

} // namespace bris
