#pragma once

#include "engine/column.hpp"

#include <memory>
#include <span>
#include <string>
#include <vector>

namespace bris {

/// The columns of one kind of entity, all of the same length. A column exists for every row or for
/// none.
class Table {
public:
    explicit Table(std::string name) : name_(std::move(name)) {}
    Table(const Table& other);
    /// Some rows of another table, in this order; values that are not carried are zero.
    Table(const Table& other, std::span<const Row> rows);
    Table(Table&&) = default;

    const std::string& name() const { return name_; }
    std::size_t size() const { return size_; }

    /// Adds the column unless it exists; new values are zero.
    template <Component C>
    std::span<typename C::Value> add() {
        if (find(typeid(C)) == nullptr) add(Column::type_of<C>());
        return column<C>();
    }
    template <Component C>
    bool has() const {
        return find(typeid(C)) != nullptr;
    }
    /// All values of a column, by row. The column must exist.
    template <Component C>
    std::span<typename C::Value> column() {
        Column& c = at(typeid(C));
        return {reinterpret_cast<typename C::Value*>(c.bytes()), size_};
    }
    template <Component C>
    std::span<const typename C::Value> column() const {
        const Column& c = at(typeid(C));
        return {reinterpret_cast<const typename C::Value*>(c.bytes()), size_};
    }

    Column* find(std::type_index component);
    const Column* find(std::type_index component) const;
    const std::vector<std::unique_ptr<Column>>& columns() const { return columns_; }

    /// Changes the number of rows of every column; new rows are zero.
    void resize(std::size_t rows);
    /// Keeps these rows only, in this order: row `rows[r]` moves to row r.
    void keep(std::span<const Row> rows);
    /// Removes all rows and their memory.
    void release();

    /// Marks blocks of `idle_rows` rows that row-local systems skip, one flag per block; empty: no
    /// block is skipped.
    static constexpr std::size_t idle_rows = 64;
    void leave_idle(std::vector<std::uint8_t> blocks) { idle_ = std::move(blocks); }
    bool is_idle(std::size_t first, std::size_t last) const {
        if (idle_.empty()) return false;
        for (std::size_t block = first / idle_rows; block * idle_rows < last; ++block)
            if (idle_[block] == 0) return false;
        return true;
    }

private:
    void add(Column::Type type);
    Column& at(std::type_index component);
    const Column& at(std::type_index component) const;

    std::string name_;
    std::size_t size_ = 0;
    std::vector<std::uint8_t> idle_;
    std::vector<std::unique_ptr<Column>> columns_; // few: searched front to back
};

} // namespace bris
