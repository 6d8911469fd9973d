#include "components/fouling.hpp"
#include "components/membrane.hpp"
#include "components/recorder.hpp"
#include "components/sensor.hpp"
#include "components/sleep.hpp"
#include "engine/health.hpp"
#include "engine/ranks.hpp"
#include "systems/slabs/body_rows.hpp"
#include "systems/slabs/cuts.hpp"
#include "systems/slabs/slabs.hpp"

#include <algorithm>
#include <array>
#include <cstring>

namespace bris {

namespace {

/// Every step passes position, velocity, acceleration and two angular velocities, and in scenes of
/// clumps the orientation.
template <class... Cs, class BodyRows>
void pass_motion(const BodyRows& bodies, Slab& slab) {
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

std::string reason_not_to_divide(const World& world) {
    if (world.has_resource<Sleep>()) return "bodies that sleep";
    if (world.has<Sensors>()) return "sensors";
    if (world.table<Bodies>().has<RecorderOf>()) return "inertial recorders";
    if (world.table<Bodies>().has<FoulingAround>()) return "fines";
    return "";
}

namespace {

/// Tables of boundaries and elements are the same on all ranks, and none of their rows move.
void copy_boundaries(const World& part, World& whole) {
    const auto belongs_to_bodies = [&](const Table& table) {
        bool is = table.name() == Bodies::name || table.name() == Spheres::name;
        for_each_kind_of_pair([&]<class Pairs>() { is = is || table.name() == Pairs::name; });
        return is;
    };
    for (const auto& named : whole.tables()) {
        if (belongs_to_bodies(*named.table)) continue;
        const Table& from = *part.find_table(named.kind);
        for (const auto& column : named.table->columns())
            if (const auto& type = column->type(); type.is_state)
                std::memcpy(column->bytes(), from.find(type.component)->bytes(),
                            from.size() * type.value_size);
    }
}

} // namespace

World take_slab(const World& whole) {
    World part(whole);
    Slab slab;
    slab.rank = Ranks::rank();
    slab.axis = detail::longest_axis(whole);
    slab.widest_skin = whole.resource<ListState>().widest_skin;
    slab.cuts = detail::even_cuts(detail::work_along(whole, slab.axis, {}), Ranks::size());
    part.resource<ListSettings>().widest_skin = slab.widest_skin;
    std::vector<Row> here;
    const auto position = whole.column<Bodies, Position>();
    const detail::Reach reach(whole, slab);
    const auto run = whole.column<Bodies, SpheresOf>();
    for (Row b = 0; b < run.size(); ++b)
        if (run[b].count > 0 && slab.is_near(position[b][slab.axis], reach[b], slab.rank))
            here.push_back(b);
    detail::keep_bodies(part, here, here);
    part.table<Bodies>().add<Ghost>();
    part.add_resource(std::move(slab));
    detail::mark_ghosts(part);
    part.resource<ListState>().stale = true;
    return part;
}

void give_back(const World& part, World& whole) {
    const std::vector<Row> boundaries = detail::boundaries_of(part);
    const auto ghost = part.column<Bodies, Ghost>();
    std::vector<bool> is_boundary(ghost.size(), false);
    for (const Row b : boundaries) is_boundary[b] = true;
    std::vector<Row> own;
    for (Row b = 0; b < ghost.size(); ++b)
        if (ghost[b] == 0 && !is_boundary[b]) own.push_back(b);
    for_each_kind_of_pair([&]<class Pairs>() {
        if (whole.has<Pairs>()) whole.table<Pairs>().resize(0);
    });
    for (const auto& packed : Ranks::share(detail::pack_bodies(part, own, false)))
        detail::overwrite_bodies(whole, packed);
    detail::overwrite_bodies(whole, detail::pack_bodies(part, boundaries, false));
    copy_boundaries(part, whole);
    Archive resources;
    for (const auto& held : part.resources()) held->save(resources);
    for (const auto& held : whole.resources()) held->load(resources);
    whole.resource<Health>() = part.resource<Health>();
    whole.resource<ListState>().stale = true;
}

void share_census(const Slab&, const ListState& lists, const Clock& clock, Census& census) {
    if (lists.last_rebuild != clock.step) return;
    census.largest_radius = Ranks::largest(census.largest_radius);
    census.smallest_free_radius = -Ranks::largest(-census.smallest_free_radius);
    for (auto* count : {&census.grains, &census.hosts}) {
        std::vector<std::int64_t> of(count->begin(), count->end());
        Ranks::sum(of);
        for (std::size_t k = 0; k < of.size(); ++k) (*count)[k] = static_cast<std::uint32_t>(of[k]);
    }
}

void list_ghosts(
    Rows<Bodies, const BodyId, const Position, const BoundingRadius, const SpheresOf, const Ghost>
        bodies,
    const Census& census, const ListState& lists, const Clock& clock, Slab& slab) {
    if (lists.last_rebuild != clock.step) return;
    const EntityId* id = bodies.column<BodyId>();
    const Vec3* position = bodies.column<Position>();
    const double* radius = bodies.column<BoundingRadius>();
    const SphereRun* run = bodies.column<SpheresOf>();
    const std::uint32_t* ghost = bodies.column<Ghost>();
    std::vector<GhostRows> with(slab.cuts.size() - 1);
    for (Row b = 0; b < bodies.size(); ++b) {
        if (run[b].count == 0) continue;
        const double x = position[b][slab.axis], reach = detail::reach_of(radius[b], census, slab);
        if (ghost[b] != 0) with[slab.owner_of(x)].receive.push_back(b);
        for (unsigned r = 0; ghost[b] == 0 && r < with.size(); ++r)
            if (r != slab.rank && slab.is_near(x, reach, r)) with[r].send.push_back(b);
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

void share_boundary_forces(Rows<Bodies, const MotionOf> bodies, const Census& census, const Slab&,
                           BoundarySums& sums) {
    const auto* motion = bodies.column<MotionOf>();
    if (std::ranges::all_of(census.boundaries, [&](Row b) {
            return motion[b] == static_cast<std::uint32_t>(Motion::fixed);
        }))
        return; // nobody reads them within a step
    // three numbers for each of 128 bits, whose sums over ranks cannot overflow
    constexpr WideInteger base = WideInteger{1} << 32;
    std::vector<std::int64_t> limbs;
    for (const auto& of_body : sums.of)
        for (WideInteger value : of_body)
            for (int k = 0; k < 3; ++k) {
                const auto low = static_cast<std::int64_t>(value & (base - 1));
                limbs.push_back(k < 2 ? low : static_cast<std::int64_t>(value));
                value = (value - low) / base;
            }
    Ranks::sum(limbs);
    const std::int64_t* next = limbs.data();
    for (auto& of_body : sums.of)
        for (WideInteger& value : of_body) {
            value = next[0] + base * (next[1] + base * WideInteger{next[2]});
            next += 3;
        }
}

void share_membrane_forces(const Slab&, ElementSums& sums) {
    std::vector<std::int64_t> total(2 * sums.elements);
    for (std::size_t k = 0; k < sums.rows.size(); ++k) {
        total[2 * (k % sums.elements)] += sums.rows[k].push;
        total[2 * (k % sums.elements) + 1] += sums.rows[k].hold;
    }
    Ranks::sum(total);
    sums.rows.resize(sums.elements);
    for (std::size_t e = 0; e < sums.elements; ++e)
        sums.rows[e] = {.push = total[2 * e], .hold = total[2 * e + 1]};
}

void pass_spheres(Rows<Bodies, const SphereInertia, Position, Velocity, Acceleration,
                       AngularVelocity, StepAngularVelocity>
                      bodies,
                  Slab& slab) {
    pass_motion<Position, Velocity, Acceleration, AngularVelocity, StepAngularVelocity>(bodies,
                                                                                        slab);
}

void pass_clumps(Rows<Bodies, Position, Velocity, Acceleration, AngularVelocity,
                      StepAngularVelocity, Orientation>
                     bodies,
                 Slab& slab) {
    pass_motion<Position, Velocity, Acceleration, AngularVelocity, StepAngularVelocity,
                Orientation>(bodies, slab);
}

} // namespace bris
