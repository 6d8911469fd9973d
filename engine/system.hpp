#pragma once

#include "engine/rows.hpp"

#include <functional>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

namespace bris {

/// One access of a system: to a column of a table, or to a resource (`table` is then the resource).
struct Access {
    std::type_index table, component;
    std::string name; ///< for messages, as "Bodies.position"
    bool writes = false;
    bool is_state = false;
    bool commutes = false; ///< writers may run in any order, and at once
    friend bool same_data(const Access& a, const Access& b) {
        return a.table == b.table && a.component == b.component;
    }
};

namespace detail {

// how each kind of parameter is declared, found and passed
template <class P>
struct Parameter;

template <class R>
struct Parameter<R&> {
    using Resource = std::remove_const_t<R>;
    static void declare(std::vector<Access>& list) {
        bool is_state = false;
        if constexpr (requires { Resource::is_state; }) is_state = Resource::is_state;
        constexpr bool writes = !std::is_const_v<R>, commutes = requires {
            Resource::writers_commute;
        };
        list.push_back({typeid(Resource), typeid(Resource), Resource::name, writes, is_state,
                        writes && commutes});
    }
    static bool present(const World& world) { return world.has_resource<Resource>(); }
    static std::string missing(const World& world) {
        return present(world) ? "" : std::string("no ") + Resource::name;
    }
    static bool lacks_only_columns(const World& world) { return present(world); }
    explicit Parameter(World& world) : resource(&world.resource<Resource>()) {}
    R& get(std::optional<RowRange>) const { return *resource; }
    Resource* resource;
};

template <>
struct Parameter<World&> {
    static void declare(std::vector<Access>&) {}
    static std::string missing(const World&) { return ""; }
    static bool lacks_only_columns(const World&) { return true; }
    explicit Parameter(World& w) : world(&w) {}
    World& get(std::optional<RowRange>) const { return *world; }
    World* world;
};

template <class K, class... Cs>
struct Parameter<Rows<K, Cs...>> {
    static void declare(std::vector<Access>& list) {
        (list.push_back({typeid(K), typeid(std::remove_const_t<Cs>),
                         std::string(K::name) + "." + Cs::name, !std::is_const_v<Cs>,
                         Cs::is_state}),
         ...);
    }
    static std::string missing(const World& world) {
        const Table* table = world.find_table(typeid(K));
        if (table == nullptr) return std::string("no ") + K::name;
        std::string lacking;
        ((lacking += table->find(typeid(std::remove_const_t<Cs>)) == nullptr
                         ? (lacking.empty() ? "no " : ", ") + std::string(K::name) + "." + Cs::name
                         : ""),
         ...);
        return lacking;
    }
    static bool lacks_only_columns(const World& world) {
        return world.find_table(typeid(K)) != nullptr;
    }
    explicit Parameter(World& world)
        : table(world.find_table(typeid(K))), columns{table->find(
                                                  typeid(std::remove_const_t<Cs>))...} {}
    Rows<K, Cs...> get(std::optional<RowRange> range) const {
        std::array<std::byte*, sizeof...(Cs)> bytes;
        for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = columns[i]->bytes();
        return {bytes, table->size(), range.value_or(RowRange{0, static_cast<Row>(table->size())})};
    }
    Table* table;
    std::array<Column*, sizeof...(Cs)> columns;
};

} // namespace detail

/// A named function with the data that it reads and writes, both derived from its signature.
/// Parameters are Rows<Kind, const Read, Write>, `const Resource&`, `Resource&`, or `World&`
/// (everything).
struct System {
    using Call = std::function<void(std::optional<RowRange>)>;

    std::string name;
    std::vector<Access> accesses;
    bool whole_world = false;                 ///< takes World&: conflicts with every system
    std::optional<std::type_index> row_local; ///< works row by row on this table
    std::string row_local_name;
    /// What the scene lacks for this system; empty: nothing.
    std::function<std::string(const World&)> missing;
    std::function<Call(World&)> bind;
    bool (*due)(const World&) = nullptr; ///< null: due in every step
    /// If the tables exist, the columns must exist too.
    bool required = false;
    /// Names of systems: where exactly these run one after another, this one runs instead, with the
    /// same result. Elsewhere it is left out. Empty: it runs for itself.
    std::vector<std::string> combines;
    /// Whether all tables and resources exist.
    bool (*lacks_only_columns)(const World&) = nullptr;
};

namespace detail {

template <class... Ps>
System make_system(std::string name, void (*function)(Ps...)) {
    System system;
    system.name = std::move(name);
    (Parameter<Ps>::declare(system.accesses), ...);
    system.whole_world = (std::is_same_v<Ps, World&> || ...);
    system.missing = [](const World& world) {
        std::string all;
        const auto note = [&](std::string one) {
            if (!one.empty()) all += (all.empty() ? "" : "; ") + one;
        };
        (note(Parameter<Ps>::missing(world)), ...);
        return all;
    };
    system.lacks_only_columns = [](const World& world) {
        return (Parameter<Ps>::lacks_only_columns(world) && ...);
    };
    system.bind = [function](World& world) -> System::Call {
        return [function, parameters = std::tuple<Parameter<Ps>...>(Parameter<Ps>(world)...)](
                   std::optional<RowRange> range) {
            // only the first parameter of a row-local system is divided into chunks
            [&]<std::size_t... I>(std::index_sequence<I...>) {
                function(std::get<I>(parameters).get(I == 0 ? range : std::nullopt)...);
            }
            (std::index_sequence_for<Ps...>{});
        };
    };
    return system;
}

template <class K, class... Cs, class... Ps>
std::type_index first_table(void (*)(Rows<K, Cs...>, Ps...), std::string& name) {
    name = K::name;
    return typeid(K);
}

} // namespace detail

/// A system that runs once a step over whole tables.
template <class... Ps>
System system(std::string name, void (*function)(Ps...)) {
    return detail::make_system(std::move(name), function);
}

/// A system that works on each row of its first table independently: it must write only what
/// belongs to that row. Adjacent row-local systems on the same table run as one pass over chunks of
/// rows.
template <class... Ps>
System row_local(std::string name, void (*function)(Ps...)) {
    System s = detail::make_system(std::move(name), function);
    s.row_local = detail::first_table(function, s.row_local_name);
    return s;
}

/// The same system, run only in steps in which `due` returns true.
inline System when(bool (*due)(const World&), System system) {
    system.due = due;
    return system;
}

/// The same system, which must not be left out because of a missing column alone: a scene with its
/// tables and resources but without its columns is inconsistent, and Schedule::prepare throws.
inline System required(System system) {
    system.required = true;
    return system;
}

/// The same system, which replaces `systems` where nothing else runs between them or in their pass.
inline System combined(std::vector<std::string> systems, System system) {
    system.combines = std::move(systems);
    return system;
}

using StepList = std::vector<System>;

} // namespace bris
