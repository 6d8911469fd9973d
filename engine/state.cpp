#include "engine/state.hpp"

#include "engine/errors.hpp"
#include "engine/ordering.hpp"

#include <algorithm>

namespace bris {

namespace {

// null if the rows have no key, or no other State (candidate pairs without history)
const Column* key_of(const Table& table) {
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

bool key_less(const Column& key, Row a, Row b) {
    const std::size_t width = key.type().value_size, numbers = width / sizeof(std::uint32_t);
    const auto* base = reinterpret_cast<const std::uint32_t*>(key.bytes());
    return std::lexicographical_compare(base + a * numbers, base + (a + 1) * numbers,
                                        base + b * numbers, base + (b + 1) * numbers);
}

std::vector<Row> rows_to_save(const Table& table, const Column& key) {
    std::vector<Row> rows = all_rows(table.size());
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

std::string path_of(const Table& table, const Column& column) {
    return table.name() + "/" + column.type().name;
}

} // namespace

Archive save_state(const World& world) {
    Archive archive;
    for (const auto& named : world.tables()) {
        const Table& table = *named.table;
        const Column* key = key_of(table);
        if (key == nullptr) continue;
        const auto rows = rows_to_save(table, *key);
        for (const auto& column : table.columns()) {
            const auto& type = column->type();
            if (!type.is_state) continue;
            Archive::Array array{path_of(table, *column),
                                 type.scalar,
                                 type.scalar_size,
                                 type.value_size / type.scalar_size,
                                 {},
                                 path_of(table, *key)};
            array.bytes.resize(rows.size() * type.value_size);
            for (std::size_t i = 0; i < rows.size(); ++i)
                std::memcpy(array.bytes.data() + i * type.value_size,
                            column->bytes() + rows[i] * type.value_size, type.value_size);
            archive.put(std::move(array));
        }
    }
    for (const auto& held : world.resources()) held->save(archive);
    return archive;
}

void add_absent_columns(Archive& archive, const World& world) {
    for (const auto& named : world.tables()) {
        const Table& table = *named.table;
        const Column* key = key_of(table);
        const Archive::Array* keys = key == nullptr ? nullptr : archive.find(path_of(table, *key));
        if (keys == nullptr) continue;
        const std::size_t rows = keys->rows();
        for (const auto& column : table.columns()) {
            const auto& type = column->type();
            const std::string path = path_of(table, *column);
            if (!type.is_state || archive.find(path) != nullptr) continue;
            archive.put({path, type.scalar, type.scalar_size, type.value_size / type.scalar_size,
                         std::vector<std::byte>(rows * type.value_size), path_of(table, *key)});
        }
    }
}

void load_state(World& world, const Archive& archive) {
    for (const auto& named : world.tables()) {
        Table& table = *named.table;
        const Column* key = key_of(table);
        if (key == nullptr) continue;
        const Archive::Array* keys = archive.find(path_of(table, *key));
        require(keys != nullptr, "checkpoint: expected the table '" + table.name() +
                                     "', found none (checkpoint of another scene?)");
        table.resize(0);
        table.resize(keys->rows());
        for (const auto& column : table.columns()) {
            const auto& type = column->type();
            if (!type.is_state) continue;
            const Archive::Array* array = archive.find(path_of(table, *column));
            require(array != nullptr && array->bytes.size() == table.size() * type.value_size,
                    "checkpoint: '" + path_of(table, *column) + "': expected " +
                        std::to_string(table.size()) + " rows, found " +
                        (array == nullptr ? "none" : "another number or type"));
            if (!array->bytes.empty())
                std::memcpy(column->bytes(), array->bytes.data(), array->bytes.size());
        }
    }
    for (const auto& held : world.resources()) held->load(archive);
}

} // namespace bris
