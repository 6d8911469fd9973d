#pragma once

#include "components/outline.hpp"
#include "engine/component.hpp"
#include "engine/entity.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace bris {

/// Of a rank's part of a world: 1 if another rank computes the motion of the body, else 0. Exists
/// only where a world is divided among ranks.
struct Ghost : Derived<std::uint32_t> {
    static constexpr auto name = "ghost", unit = "";
};

/// Which bodies are ghosts: none where the world is not divided.
class Ghosts {
public:
    template <class Table>
    explicit Ghosts(const Table& bodies)
        : flag_(bodies.template has<Ghost>() ? bodies.template column<Ghost>().data() : nullptr) {}
    bool operator[](Row b) const { return flag_ != nullptr && flag_[b] != 0; }

private:
    const std::uint32_t* flag_;
};

/// Bodies of which one rank sends the motion to another in every step, by ascending id on both
/// sides.
struct GhostRows {
    unsigned rank = 0;
    std::vector<Row> send, receive;
    std::vector<std::byte> sent, received; ///< messages of one step
};

/// Another slab that reaches to this one.
struct NearSlab {
    unsigned rank = 0;
    Outline outline; ///< of its bodies
};

/// The slab of this rank: the bodies with spheres whose centres lie in it are computed here. Ghosts
/// are the bodies of other slabs within reach of it. Boundaries are on all ranks.
struct Slab {
    static constexpr auto name = "slab";
    int axis = 0;                  ///< along which the world is divided: 0, 1, 2 for x, y, z
    std::vector<double> cuts;      ///< m, ranks + 1, ascending; the outer ones are infinite
    unsigned rank = 0;             ///< of this process
    bool just_taken = true;        ///< and no step has been run
    Outline outline;               ///< of the bodies of this slab
    std::vector<NearSlab> near;    ///< by rank; without this one
    Row first_ghost = 0;           ///< the rows of Bodies from here on are ghosts
    std::vector<GhostRows> ghosts; ///< by rank; only those with which bodies are shared

    unsigned ranks() const { return static_cast<unsigned>(cuts.size() - 1); }
    unsigned owner_of(double x) const {
        return static_cast<unsigned>(std::upper_bound(cuts.begin() + 1, cuts.end() - 1, x) -
                                     (cuts.begin() + 1));
    }
    /// Calls visit(rank) for the slabs that need a body: its own one, and those with bodies that it
    /// may touch before new lists are made. `reach`: its bounding radius and outer skin (m).
    template <class Visit>
    void for_slabs_that_need(const Vec3& x, double reach, Visit&& visit) const {
        const unsigned owner = owner_of(x[axis]);
        visit(owner);
        if (rank != owner && outline.may_touch(x, reach)) visit(rank);
        for (const NearSlab& slab : near)
            if (slab.rank != owner && slab.outline.may_touch(x, reach)) visit(slab.rank);
    }
};

/// How a world is first divided of which each rank has made only the grains in its slab and near
/// it. Whoever divides it uses the plan up.
struct SlabPlan {
    static constexpr auto name = "slab_plan";
    int axis = 0;
    Vec3 low = Vec3::Zero(), high = Vec3::Zero(); ///< m, of a box with the centres of all grains
    std::vector<double> cuts = {};                ///< as those of Slab; empty: there is no plan
};

} // namespace bris
