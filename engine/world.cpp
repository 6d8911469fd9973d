#include "engine/world.hpp"

namespace bris {

World::World(const World& other) : World(other, [](const Table&) { return std::nullopt; }) {}

World::World(const World& other,
             const std::function<std::optional<std::vector<Row>>(const Table&)>& rows_of) {
    for (const auto& [kind, table] : other.tables_) {
        const auto rows = rows_of(*table);
        tables_.push_back({kind, rows ? std::make_unique<Table>(*table, *rows)
                                      : std::make_unique<Table>(*table)});
    }
    for (const auto& held : other.resources_) resources_.push_back(held->clone());
}

Table* World::find_table(std::type_index kind) {
    for (auto& named : tables_)
        if (same_type(named.kind, kind)) return named.table.get();
    return nullptr;
}

const Table* World::find_table(std::type_index kind) const {
    return const_cast<World*>(this)->find_table(kind);
}

World::HeldBase* World::find_resource(std::type_index type) {
    for (auto& held : resources_)
        if (same_type(held->type, type)) return held.get();
    return nullptr;
}

const World::HeldBase* World::find_resource(std::type_index type) const {
    return const_cast<World*>(this)->find_resource(type);
}

} // namespace bris
