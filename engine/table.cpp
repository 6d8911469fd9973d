#include "engine/table.hpp"

#include <stdexcept>

namespace bris {

Table::Table(const Table& other) : name_(other.name_), size_(other.size_) {
    for (const auto& column : other.columns_) columns_.push_back(std::make_unique<Column>(*column));
}

Table::Table(const Table& other, std::span<const Row> rows) : name_(other.name_) {
    for (const auto& column : other.columns_)
        columns_.push_back(std::make_unique<Column>(*column, rows));
    size_ = rows.size();
}

Column* Table::find(std::type_index component) {
    for (auto& column : columns_)
        if (same_type(column->type().component, component)) return column.get();
    return nullptr;
}

const Column* Table::find(std::type_index component) const {
    return const_cast<Table*>(this)->find(component);
}

Column& Table::at(std::type_index component) {
    if (Column* column = find(component)) return *column;
    throw std::logic_error(name_ + " has no column " + component.name());
}

const Column& Table::at(std::type_index component) const {
    return const_cast<Table*>(this)->at(component);
}

void Table::add(Column::Type type) {
    columns_.push_back(std::make_unique<Column>(std::move(type)));
    columns_.back()->resize(size_);
}

void Table::resize(std::size_t rows) {
    for (auto& column : columns_) column->resize(rows);
    size_ = rows;
}

void Table::release() {
    for (auto& column : columns_) column->release();
    size_ = 0;
    idle_.clear();
}

void Table::keep(std::span<const Row> rows) {
    for (auto& column : columns_) column->keep(rows);
    size_ = rows.size();
}

} // namespace bris
