#pragma once

#include "components/settings.hpp"
#include "systems/loads/table.hpp"

#include <tuple>

namespace bris {

/// Forces on bodies other than contact forces: weight, and those of force elements. Valid as long
/// as the world's tables are not changed.
class OuterForces {
public:
    explicit OuterForces(const World& world)
        : mass_(world.column<Bodies, Mass>().data()),
          gravity_(world.has_resource<Gravity>() ? world.resource<Gravity>().value
                                                 : Vec3(Vec3::Zero())),
          any_(world.has_resource<Gravity>()) {
        find(world.table<Bodies>(), ForceElements{});
    }
    bool any() const { return any_; }
    /// Force (N) on the body of a row.
    Vec3 operator()(Row row) const {
        Vec3 force = mass_[row] * gravity_;
        visit(row, [&]<class E>(const Vec3& of_element) { force += of_element; });
        return force;
    }

    /// Sum of the magnitudes of the forces on the body of a row, N; the weight and what counts as
    /// weight are one force.
    double magnitude(Row row) const {
        Vec3 weight = mass_[row] * gravity_;
        visit(row, [&]<class E>(const Vec3& force) {
            if constexpr (E::counts_as_weight) weight += force;
        });
        double sum = weight.norm();
        visit(row, [&]<class E>(const Vec3& force) {
            if constexpr (!E::counts_as_weight) sum += force.norm();
        });
        return sum;
    }

private:
    template <class E>
    struct Acting {
        const typename E::Acting::Value* value = nullptr; ///< by row; null: the scene has none
    };
    template <class... Es>
    static std::tuple<Acting<Es>...> acting_of(ElementList<Es...>);

    // for_each_element would do for both, but makes clang 19 crash
    template <class... Es>
    void find(const Table& bodies, ElementList<Es...>) {
        const auto one = [&]<class E>(Acting<E>& acting) {
            if (!bodies.has<typename E::Acting>()) return;
            acting.value = bodies.column<typename E::Acting>().data();
            any_ = true;
        };
        (one(std::get<Acting<Es>>(acting_)), ...);
    }

    /// Calls visit.template operator()<E>(force) for the elements that a scene has.
    template <class Visit>
    void visit(Row row, Visit&& visit) const {
        visit_each(row, visit, ForceElements{});
    }
    template <class Visit, class... Es>
    void visit_each(Row row, Visit& visit, ElementList<Es...>) const {
        const auto one = [&]<class E>(const Acting<E>& acting) {
            if (acting.value != nullptr) visit.template operator()<E>(acting.value[row].force);
        };
        (one(std::get<Acting<Es>>(acting_)), ...);
    }

    const double* mass_;
    Vec3 gravity_;
    bool any_;
    decltype(acting_of(ForceElements{})) acting_;
};

} // namespace bris
