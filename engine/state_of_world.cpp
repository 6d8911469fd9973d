#include "engine/state_of_world.hpp"

#include "engine/ordering.hpp"
#include "engine/ranks.hpp"
#include "engine/rows_of_ranks.hpp"

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

/// A State column of a table, as an array without rows.
Archive::Array array_of(const Table& table, const Column& column, const Column& key) {
    const auto& type = column.type();
    return {path_in_state(table, column),       type.scalar, type.scalar_size,
            type.value_size / type.scalar_size, {},          path_in_state(table, key)};
}

/// The values of rows of a column.
std::vector<std::byte> values_of(const Column& column, std::span<const Row> rows) {
    const std::size_t width = column.type().value_size;
    std::vector<std::byte> bytes(rows.size() * width);
    for (std::size_t k = 0; k < rows.size(); ++k)
        std::memcpy(bytes.data() + k * width, column.bytes() + rows[k] * width, width);
    return bytes;
}

/// The rows that this rank gives of a table, in pieces.
class PiecesOfTable {
public:
    PiecesOfTable(const Table& table, const Column& key, std::vector<Row> rows, bool is_divided)
        : table_(table), key_(key), rows_(std::move(rows)), is_divided_(is_divided) {}

    void visit(const StateSource::Visit& visit) const {
        std::vector<const Column*> columns;
        for (const auto& column : table_.columns())
            if (column->type().is_state) columns.push_back(column.get());
        StatePiece piece;
        piece.arrays = columns.size();
        piece.rows_of_table = number_of_rows();
        std::size_t next = 0;
        bool is_first = true; // arrays without rows have one piece, for their shape
        for (auto ids = next_ids(next); ids || is_first; ids = next_ids(next)) {
            is_first = false;
            std::size_t end = next;
            while (end < rows_.size() && ids_at(end) == *ids) ++end;
            const auto rows = std::span(rows_).subspan(next, end - next);
            next = end;
            piece.ids = ids.value_or(0);
            auto numbers = first_numbers(rows);
            const RowsOfRanks of_ranks(numbers, is_divided_);
            for (piece.number = 0; piece.number < columns.size(); ++piece.number)
                visit_column(*columns[piece.number], rows, of_ranks, piece, visit);
            of_ranks.wait_for_writer();
            piece.first_row += of_ranks.size();
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
    std::vector<std::uint32_t> first_numbers(std::span<const Row> rows) const {
        std::vector<std::uint32_t> numbers;
        for (const Row row : rows) numbers.push_back(first_number(key_, row));
        return numbers;
    }
    void visit_column(const Column& column, std::span<const Row> rows, const RowsOfRanks& of_ranks,
                      StatePiece& piece, const StateSource::Visit& visit) const {
        const Archive::Array array = array_of(table_, column, key_);
        std::vector<std::byte> bytes = values_of(column, rows);
        of_ranks.gather(bytes);
        piece.array = &array;
        piece.bytes = bytes;
        if (!is_divided_ || Ranks::is_first()) visit(piece);
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
    bris::for_pieces(resources, visit);
}

} // namespace bris
