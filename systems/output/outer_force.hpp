#pragma once

#include "components/settings.hpp"
#include "systems/loads/table.hpp"

#include <tuple>

namespace bris {

namespace detail {

// not within the class, where clang 19 forgets to compile what depends on them
template <class E>
struct ActingOf {
    const typename E::Acting::Value* value = nullptr; ///< by row; null: the scene has none
};
template <class... Es>
std::tuple<ActingOf<Es>...> acting_of(ElementList<Es...>);

} // namespace detail

/// Forces on bodies other than contact forces: weight, and those of force elements. Valid as long
/// as the world's tables are not changed.
class OuterForces {
public:
    explicit OuterForces(const World& world)
        : mass_(world.column<Bodies, Mass>().data()),
          gravity_(world.has_resource<Gravity>() ? world.resource<Gravity>().value
                                                 : Vec3(Vec3::Zero())),
          any_(world.has_resource<Gravity>()) {
        for_each_element_of(world, [&]<class E>() {
            std::get<detail::ActingOf<E>>(acting_).value =
                world.column<Bodies, typename E::Acting>().data();
            any_ = true;
        });
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
    template <class Visit>
    void visit(Row row, Visit&& visit) const {
        for_each_element([&]<class E>() {
            if (const auto* value = std::get<detail::ActingOf<E>>(acting_).value)
                visit.template operator()<E>(value[row].force);
        });
    }

    const double* mass_;
    Vec3 gravity_;
    bool any_;
    decltype(detail::acting_of(ForceElements{})) acting_;
};

} // namespace bris
