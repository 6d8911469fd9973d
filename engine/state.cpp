#include "engine/state.hpp"

#include "engine/errors.hpp"
#include "engine/state_of_world.hpp"

#include <cstring>
#include <utility>
#include <vector>

namespace bris {

Archive save_state(const World& world) {
    std::vector<Archive::Array> arrays;
    std::size_t first = 0; // of the present table
    StateOfWorld(world).for_pieces([&](const StatePiece& piece) {
        if (piece.first_row == 0) {
            if (piece.number == 0) first = arrays.size();
            arrays.push_back(piece.layout());
            arrays.back().bytes.reserve(piece.rows_of_table * arrays.back().width());
        }
        auto& bytes = arrays[first + piece.number].bytes;
        bytes.insert(bytes.end(), piece.bytes.begin(), piece.bytes.end());
    });
    Archive archive;
    for (Archive::Array& array : arrays) archive.put(std::move(array));
    return archive;
}

void add_absent_columns(Archive& archive, const World& world) {
    for (const auto& named : world.tables()) {
        const Table& table = *named.table;
        const Column* key = key_of_state(table);
        const Archive::Array* keys =
            key == nullptr ? nullptr : archive.find(path_in_state(table, *key));
        if (keys == nullptr) continue;
        const std::size_t rows = keys->rows();
        for (const auto& column : table.columns()) {
            const auto& type = column->type();
            const std::string path = path_in_state(table, *column);
            if (!type.is_state || archive.find(path) != nullptr) continue;
            archive.put({path, type.scalar, type.scalar_size, type.value_size / type.scalar_size,
                         std::vector<std::byte>(rows * type.value_size),
                         path_in_state(table, *key)});
        }
    }
}

void load_state(World& world, const Archive& archive) {
    for (const auto& named : world.tables()) {
        Table& table = *named.table;
        const Column* key = key_of_state(table);
        if (key == nullptr) continue;
        const Archive::Array* keys = archive.find(path_in_state(table, *key));
        require(keys != nullptr, "checkpoint: expected the table '" + table.name() +
                                     "', found none (checkpoint of another scene?)");
        table.resize(0);
        table.resize(keys->rows());
        for (const auto& column : table.columns()) {
            const auto& type = column->type();
            if (!type.is_state) continue;
            const Archive::Array* array = archive.find(path_in_state(table, *column));
            require(array != nullptr && array->bytes.size() == table.size() * type.value_size,
                    "checkpoint: '" + path_in_state(table, *column) + "': expected " +
                        std::to_string(table.size()) + " rows, found " +
                        (array == nullptr ? "none" : "another number or type"));
            if (!array->bytes.empty())
                std::memcpy(column->bytes(), array->bytes.data(), array->bytes.size());
        }
    }
    for (const auto& held : world.resources()) held->load(archive);
}

} // namespace bris
