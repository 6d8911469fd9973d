#pragma once

#include "components/body.hpp"
#include "components/kinds.hpp"
#include "engine/world.hpp"

namespace bris::detail {

/// Poses of all bodies, now or as noted in the columns At and Turned; without a column of
/// orientations all are the identity.
template <class At = Position, class Turned = Orientation>
class Poses {
public:
    explicit Poses(const World& world)
        : position_(world.column<Bodies, At>()),
          orientation_(world.table<Bodies>().has<Turned>() ? world.column<Bodies, Turned>().data()
                                                           : nullptr) {}
    Pose operator[](Row b) const {
        return {position_[b], orientation_ != nullptr ? orientation_[b] : Quat(Quat::Identity())};
    }

private:
    std::span<const Vec3> position_;
    const Quat* orientation_;
};

/// Writes the poses of all bodies into the columns At and, if there is one, Turned: those of the
/// last prune or the last rebuild.
template <class At, class Turned>
void note_poses(World& world);

/// Finds the spheres of each body and the rows of the bodies that boundaries belong to. The spheres
/// of a body are contiguous, in the order of the bodies' rows.
void find_runs(World& world);

/// Brings EnlargedSphere up to date. Skin: InnerSkin or OuterSkin.
template <class Skin>
void locate_spheres(World& world);

} // namespace bris::detail
