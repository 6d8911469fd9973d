#pragma once

#include "engine/archive.hpp"
#include "engine/lane_count.hpp"
#include "engine/table.hpp"

#include <functional>
#include <memory>
#include <optional>
#include <typeindex>
#include <vector>

namespace bris {

/// A kind of entity: a tag type with a `name`, which identifies a table.
template <class K>
concept Kind = requires {
    K::name;
};

inline namespace BRIS_LANES {

/// The tables and resources of one scene. A resource is a single value, found by its type; a
/// resource that is State has `save(Archive&)` and `load(const Archive&)`.
class World {
public:
    World() = default;
    World(const World& other);
    /// Some rows of the tables of another world (Table says what of them), and its resources.
    /// `rows_of`: of a table; nullopt: all of it, with Derived values.
    World(const World& other,
          const std::function<std::optional<std::vector<Row>>(const Table&)>& rows_of);
    World(World&&) = default;
    World& operator=(World&&) = default;

    /// The table of a kind, created empty on first use.
    template <Kind K>
    Table& table() {
        if (Table* t = find_table(typeid(K))) return *t;
        tables_.push_back({typeid(K), std::make_unique<Table>(K::name)});
        return *tables_.back().table;
    }
    template <Kind K>
    const Table& table() const {
        return *find_table(typeid(K));
    }
    template <Kind K>
    bool has() const {
        return find_table(typeid(K)) != nullptr;
    }
    template <Kind K, Component C>
    auto column() {
        return table<K>().template column<C>();
    }
    template <Kind K, Component C>
    auto column() const {
        return table<K>().template column<C>();
    }

    /// The resource of a type, which must exist; add_resource creates or replaces it.
    template <class R>
    R& resource() {
        return static_cast<Held<R>*>(find_resource(typeid(R)))->value;
    }
    template <class R>
    const R& resource() const {
        return static_cast<const Held<R>*>(find_resource(typeid(R)))->value;
    }
    template <class R>
    R& add_resource(R value = {}) {
        if (find_resource(typeid(R)) == nullptr)
            resources_.push_back(std::make_unique<Held<R>>(std::move(value)));
        else
            resource<R>() = std::move(value);
        return resource<R>();
    }
    template <class R>
    bool has_resource() const {
        return find_resource(typeid(R)) != nullptr;
    }

    Table* find_table(std::type_index kind);
    const Table* find_table(std::type_index kind) const;

    struct Named {
        std::type_index kind;
        std::unique_ptr<Table> table;
    };
    const std::vector<Named>& tables() const { return tables_; }
    /// Number of rows of all tables.
    std::size_t rows() const {
        std::size_t sum = 0;
        for (const Named& named : tables_) sum += named.table->size();
        return sum;
    }

    struct HeldBase {
        HeldBase(std::type_index t, bool whole) : type(t), changes_in_whole_steps_only(whole) {}
        virtual ~HeldBase() = default;
        virtual std::unique_ptr<HeldBase> clone() const = 0;
        virtual void save(Archive&) const {}
        virtual void load(const Archive&) {}
        std::type_index type;
        /// True if it says so itself: where a world is divided among ranks, no part changes it.
        bool changes_in_whole_steps_only;
    };
    std::vector<std::unique_ptr<HeldBase>>& resources() { return resources_; }
    const std::vector<std::unique_ptr<HeldBase>>& resources() const { return resources_; }
    HeldBase* find_resource(std::type_index type);
    const HeldBase* find_resource(std::type_index type) const;

private:
    template <class R>
    struct Held final : HeldBase {
        explicit Held(R v)
            : HeldBase(
                  typeid(R), requires { R::changes_in_whole_steps_only; }),
              value(std::move(v)) {}
        std::unique_ptr<HeldBase> clone() const override { return std::make_unique<Held>(value); }
        void save(Archive& archive) const override {
            if constexpr (requires { value.save(archive); }) value.save(archive);
        }
        void load(const Archive& archive) override {
            if constexpr (requires { value.load(archive); }) value.load(archive);
        }
        R value;
    };
    std::vector<Named> tables_;
    std::vector<std::unique_ptr<HeldBase>> resources_;
};

} // namespace BRIS_LANES

} // namespace bris
