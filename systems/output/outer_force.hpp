#pragma once

#include "components/body.hpp"
#include "components/kinds.hpp"
#include "components/sensor.hpp"
#include "components/settings.hpp"
#include "engine/world.hpp"

namespace bris {

/// Forces on bodies other than contact forces: weight, and the nudging of sensor rocks. Valid as
/// long as the world's tables are not changed.
class OuterForces {
public:
    explicit OuterForces(const World& world)
        : mass_(world.column<Bodies, Mass>().data()),
          nudging_(world.table<Bodies>().has<Nudging>() ? world.column<Bodies, Nudging>().data()
                                                        : nullptr),
          gravity_(world.has_resource<Gravity>() ? world.resource<Gravity>().value
                                                 : Vec3(Vec3::Zero())),
          any_(nudging_ != nullptr || world.has_resource<Gravity>()) {}
    bool any() const { return any_; }
    /// Force (N) on the body of a row.
    Vec3 operator()(Row row) const {
        const Vec3 weight = mass_[row] * gravity_;
        return nudging_ != nullptr ? Vec3(weight + nudging_[row].force) : weight;
    }

private:
    const double* mass_;
    const NudgingRow* nudging_;
    Vec3 gravity_;
    bool any_;
};

} // namespace bris
