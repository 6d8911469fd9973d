#pragma once

#include "components/outlines.hpp"
#include "engine/component.hpp"
#include "engine/entity.hpp"

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

/// The slab of this rank: the bodies with spheres whose centres lie in it are computed here. Ghosts
/// are the bodies of other slabs within reach of it. Boundaries are on all ranks.
struct Slab {
    static constexpr auto name = "slab";
    int axis = 0;                  ///< along which the world is divided: 0, 1, 2 for x, y, z
    std::vector<double> cuts;      ///< m, ranks + 1, ascending; the outer ones are infinite
    unsigned rank = 0;             ///< of this process
    Outlines outlines;             ///< of the bodies of each slab
    Row first_ghost = 0;           ///< the rows of Bodies from here on are ghosts
    std::vector<GhostRows> ghosts; ///< by rank; only those with which bodies are shared

    std::size_t owner_of(double x) const {
        std::size_t rank_of = 0;
        while (rank_of + 2 < cuts.size() && !(x < cuts[rank_of + 1])) ++rank_of;
        return rank_of;
    }
    /// Whether a slab needs a body: its own ones, and those that may touch one of them before new
    /// lists are made. `reach`: its bounding radius and outer skin (m).
    bool needs(std::size_t of_rank, const Vec3& x, double reach) const {
        return owner_of(x[axis]) == of_rank || outlines.may_touch(of_rank, x, reach);
    }
};

} // namespace bris
