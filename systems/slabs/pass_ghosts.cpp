#include "engine/ranks.hpp"
#include "systems/slabs/cuts.hpp"
#include "systems/slabs/slabs.hpp"

#include <algorithm>
#include <cstring>

namespace bris {

namespace {

/// Gives ghosts the values of these columns that their own ranks have computed.
template <class... Cs, class BodyRows>
void pass_columns(const BodyRows& bodies, Slab& slab) {
    constexpr std::size_t width = (sizeof(typename Cs::Value) + ...);
    const auto for_columns = [&](Row b, auto&& visit) {
        (visit(bodies.template column<Cs>()[b]), ...);
    };
    std::vector<Ranks::Message> send, receive;
    for (GhostRows& g : slab.ghosts) {
        g.sent.resize(g.send.size() * width);
        g.received.resize(g.receive.size() * width);
        std::byte* to = g.sent.data();
        for (const Row b : g.send)
            for_columns(b, [&](const auto& value) {
                std::memcpy(to, &value, sizeof value);
                to += sizeof value;
            });
        if (!g.sent.empty()) send.push_back({g.rank, g.sent});
        if (!g.received.empty()) receive.push_back({g.rank, g.received});
    }
    Ranks::pass(send, receive);
    for (const GhostRows& g : slab.ghosts) {
        const std::byte* from = g.received.data();
        for (const Row b : g.receive)
            for_columns(b, [&](auto& value) {
                std::memcpy(static_cast<void*>(&value), from, sizeof value);
                from += sizeof value;
            });
    }
}

} // namespace

void list_ghosts(Rows<Bodies, const BodyId, const Position, const BoundingRadius, const OuterSkin,
                      const SpheresOf, const Ghost>
                     bodies,
                 const ListState& lists, const Clock& clock, Slab& slab) {
    if (lists.last_rebuild != clock.step) return;
    const EntityId* id = bodies.column<BodyId>();
    const Vec3* position = bodies.column<Position>();
    const detail::Reach reach(bodies.column<BoundingRadius>(), bodies.column<OuterSkin>());
    const SphereRun* run = bodies.column<SpheresOf>();
    const std::uint32_t* ghost = bodies.column<Ghost>();
    std::vector<GhostRows> with(slab.ranks());
    slab.first_ghost = static_cast<Row>(std::find(ghost, ghost + bodies.size(), 1u) - ghost);
    for (Row b = 0; b < bodies.size(); ++b) {
        if (run[b].count == 0) continue;
        if (ghost[b] != 0) {
            with[slab.owner_of(position[b][slab.axis])].receive.push_back(b);
            continue;
        }
        slab.for_slabs_that_need(position[b], reach[b], [&](unsigned r) {
            if (r != slab.rank) with[r].send.push_back(b);
        });
    }
    slab.ghosts.clear();
    for (unsigned r = 0; r < with.size(); ++r) {
        with[r].rank = r;
        for (auto* rows : {&with[r].send, &with[r].receive})
            std::sort(rows->begin(), rows->end(), [&](Row a, Row b) { return id[a] < id[b]; });
        if (!with[r].send.empty() || !with[r].receive.empty())
            slab.ghosts.push_back(std::move(with[r]));
    }
}

void pass_spheres(Rows<Bodies, const SphereInertia, Position, Velocity, Acceleration,
                       AngularVelocity, StepAngularVelocity>
                      bodies,
                  Slab& slab) {
    pass_columns<Position, Velocity, Acceleration, AngularVelocity, StepAngularVelocity>(bodies,
                                                                                         slab);
}

void pass_clumps(Rows<Bodies, Position, Velocity, Acceleration, AngularVelocity,
                      StepAngularVelocity, Orientation>
                     bodies,
                 Slab& slab) {
    pass_columns<Position, Velocity, Acceleration, AngularVelocity, StepAngularVelocity,
                 Orientation>(bodies, slab);
}

void pass_resting(Rows<Bodies, Resting> bodies, Slab& slab) { pass_columns<Resting>(bodies, slab); }

} // namespace bris
