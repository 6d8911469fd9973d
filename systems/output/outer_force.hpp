#pragma once

#include "components/body.hpp"
#include "components/kinds.hpp"
#include "components/load.hpp"
#include "components/sensor.hpp"
#include "components/settings.hpp"
#include "engine/world.hpp"

namespace bris {

/// Forces on bodies other than contact forces: weight, loads, spring-dashpot patches, and the
/// nudging of sensor rocks. Valid as long as the world's tables are not changed.
class OuterForces {
public:
    explicit OuterForces(const World& world)
        : mass_(world.column<Bodies, Mass>().data()), nudging_(column_or_null<Nudging>(world)),
          load_(column_or_null<LoadForce>(world)), patch_(column_or_null<PatchForce>(world)),
          gravity_(world.has_resource<Gravity>() ? world.resource<Gravity>().value
                                                 : Vec3(Vec3::Zero())),
          any_(nudging_ != nullptr || load_ != nullptr || patch_ != nullptr ||
               world.has_resource<Gravity>()) {}
    bool any() const { return any_; }
    /// Force (N) on the body of a row.
    Vec3 operator()(Row row) const {
        Vec3 force = mass_[row] * gravity_;
        if (nudging_ != nullptr) force += nudging_[row].force;
        if (load_ != nullptr) force += load_[row].force;
        if (patch_ != nullptr) force += patch_[row].force;
        return force;
    }

    /// Sum of the magnitudes of the forces on the body of a row, N; weight and nudging count as
    /// one.
    double magnitude(Row row) const {
        Vec3 force = mass_[row] * gravity_;
        if (nudging_ != nullptr) force += nudging_[row].force;
        double sum = force.norm();
        if (load_ != nullptr) sum += load_[row].force.norm();
        if (patch_ != nullptr) sum += patch_[row].force.norm();
        return sum;
    }

private:
    template <class C>
    static const typename C::Value* column_or_null(const World& world) {
        return world.table<Bodies>().has<C>() ? world.column<Bodies, C>().data() : nullptr;
    }
    const double* mass_;
    const NudgingRow* nudging_;
    const Wrench *load_, *patch_;
    Vec3 gravity_;
    bool any_;
};

} // namespace bris
