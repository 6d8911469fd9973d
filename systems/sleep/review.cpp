#include "components/membrane.hpp"
#include "components/over_ranks.hpp"
#include "components/pair.hpp"
#include "components/sensor.hpp"
#include "components/settings.hpp"
#include "components/slab.hpp"
#include "components/sphere.hpp"
#include "engine/errors.hpp"
#include "systems/loads/table.hpp"
#include "systems/sleep/sleep.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <utility>

namespace bris {

namespace {

/// Whether bodies are awake, asleep or settled, by row. Fixed bodies are always settled.
class States {
public:
    States(const World& world, const Sleep& sleep)
        : motion_(world.column<Bodies, MotionOf>()), resting_(world.column<Bodies, Resting>()),
          steps_(sleep.steps) {}
    Sleep::State operator[](Row b) const {
        if (motion_[b] == static_cast<std::uint32_t>(Motion::fixed)) return Sleep::State::settled;
        return resting_[b] < steps_                     ? Sleep::State::awake
               : resting_[b] < steps_ + Sleep::settling ? Sleep::State::asleep
                                                        : Sleep::State::settled;
    }
    bool differ_from(const std::vector<Sleep::State>& states) const {
        if (states.size() != motion_.size()) return true;
        bool differ = false;
        for (Row b = 0; b < motion_.size(); ++b) differ |= (*this)[b] != states[b];
        return differ;
    }
    std::vector<Sleep::State> all() const {
        std::vector<Sleep::State> states(motion_.size());
        for (Row b = 0; b < motion_.size(); ++b) states[b] = (*this)[b];
        return states;
    }

private:
    std::span<const std::uint32_t> motion_, resting_;
    std::uint32_t steps_;
};

/// The two bodies of a near pair, by row.
template <class Pairs>
class PartnersOf {
public:
    explicit PartnersOf(const World& world)
        : entry_(world.column<typename Pairs::Near, NearPair>()),
          rows_(world.column<Pairs, PairRows>()), body_(world.column<Listed, ListedBody>()) {}
    std::pair<Row, Row> operator()(std::size_t k) const {
        return {body_[entry_[k].owner], rows_[entry_[k].pair].partner_body};
    }

private:
    std::span<const NearEntry> entry_;
    std::span<const PairRowNumbers> rows_;
    std::span<const Row> body_;
};

/// Sets the flags of the near pairs for which wanted(owner, partner) is true.
template <class Pairs, class Wanted>
void flag_pairs(const World& world, std::vector<std::uint8_t>& flags, Wanted&& wanted) {
    const auto& index = world.resource<NearIndex<Pairs>>();
    const PartnersOf<Pairs> partners(world);
    flags.assign(index.touching.size(), 0);
    for (const NearChunk& c : index.chunks)
        for (std::size_t k = c.first; k < c.last; ++k) {
            const auto [owner, partner] = partners(k);
            if (wanted(owner, partner))
                flags[c.first_flags + (k - c.first) / 8] |=
                    static_cast<std::uint8_t>(1u << ((k - c.first) % 8));
        }
}

/// Marks the pairs with a body that is awake, and the bodies of such pairs and of those with a body
/// that is not settled.
template <class Pairs>
void mark_awake(World& world, Sleep& sleep) {
    if (!world.has<Pairs>()) return;
    auto& index = world.resource<NearIndex<Pairs>>();
    const auto& state = sleep.states;
    flag_pairs<Pairs>(world, index.awake, [&](Row owner, Row partner) {
        if (state[owner] != Sleep::State::settled || state[partner] != Sleep::State::settled)
            sleep.busy[owner] = sleep.busy[partner] = 1;
        return state[owner] == Sleep::State::awake || state[partner] == Sleep::State::awake;
    });
}

/// Marks the pairs that are computed: those of free bodies that are awake or have a partner that
/// is, since the balance of a body needs the forces of all its contacts.
template <class Pairs>
void mark_computed(World& world, const Sleep& sleep, bool all) {
    if (!world.has<Pairs>()) return;
    auto& index = world.resource<NearIndex<Pairs>>();
    if (all) return index.look.clear();
    const auto motion = world.column<Bodies, MotionOf>();
    const auto needs_all = [&](Row b) {
        return sleep.busy[b] != 0 && motion[b] == static_cast<std::uint32_t>(Motion::free);
    };
    flag_pairs<Pairs>(world, index.look, [&](Row owner, Row partner) {
        return needs_all(owner) || needs_all(partner);
    });
}

/// Lets row-local systems skip the rows of bodies whose contacts are not computed.
void leave_idle_rows(World& world, const Sleep& sleep, bool all) {
    std::vector<std::uint8_t> idle;
    if (!all) {
        // a row is written wherever one of its pairs is computed
        std::vector<std::uint8_t> written = sleep.busy;
        const auto mark = [&]<class Pairs>() {
            if (!world.has<Pairs>()) return;
            const auto& index = world.resource<NearIndex<Pairs>>();
            const PartnersOf<Pairs> partners(world);
            index.for_flagged(index.look, [&](Row k) {
                const auto [owner, partner] = partners(k);
                written[owner] = written[partner] = 1;
            });
        };
        mark.template operator()<SpherePairs>();
        mark.template operator()<PlanePairs>();
        const Ghosts ghosts(world.table<Bodies>()); // which may be woken by bodies not known here
        for (Row b = 0; b < written.size(); ++b)
            if (ghosts[b]) written[b] = 1;
        idle.assign((written.size() + Table::idle_rows - 1) / Table::idle_rows, 1);
        for (std::size_t b = 0; b < written.size(); ++b)
            if (written[b] != 0) idle[b / Table::idle_rows] = 0;
    }
    world.table<Bodies>().leave_idle(std::move(idle));
}

} // namespace

void add_sleep(World& world, const Sleep& settings) {
    require(settings.acceleration > 0 && settings.speed > 0 && settings.steps > 0,
            "sleep: expected an acceleration, a speed and a number of steps above 0");
    require(
        !world.has<Facets>() && !world.has_resource<Membrane>(),
        "sleep: expected planes as boundaries, found facets or a membrane, on which bodies cannot "
        "sleep");
    const auto motion = world.column<Bodies, MotionOf>();
    const auto stands = [](std::uint32_t m) {
        return m == static_cast<std::uint32_t>(Motion::free) ||
               m == static_cast<std::uint32_t>(Motion::fixed);
    };
    require(std::ranges::all_of(motion, stands),
            "sleep: expected fixed boundaries, found one that is driven");
    require(!world.has<Sensors>(),
            "sleep: expected no sensors, found some: corrections would be lost on sleeping bodies");
    for_each_element_of(world, []<class E>() {
        require(
            E::wakes_bodies,
            fmt::format("sleep: expected no {}, found some: they do not wake bodies", E::plural));
    });
    Table& bodies = world.table<Bodies>();
    const auto velocity = bodies.column<Velocity>(),
               angular_velocity = bodies.column<AngularVelocity>();
    for (Row b = 0; b < motion.size(); ++b)
        require(
            motion[b] == static_cast<std::uint32_t>(Motion::free) ||
                (velocity[b] == Vec3::Zero() && angular_velocity[b] == Vec3::Zero()),
            "sleep: expected fixed bodies with velocities of 0, found one with another velocity");
    require(!bodies.has<FrictionWork>() && !bodies.has<BoundaryWork>(),
            "sleep: expected no energy budget, found one: it would miss the energy that bodies "
            "lose when "
            "they fall asleep");
    bodies.add<Resting>();
    bodies.add<HeldPose>();
    world.add_resource<Sleep>(settings);
}

void wake_all(World& world) {
    if (!world.has_resource<Sleep>()) return;
    std::ranges::fill(world.column<Bodies, Resting>(), 0u);
    std::ranges::fill(world.column<Bodies, HeldPose>(), HeldRow{});
    world.table<Bodies>().leave_idle({});
}

std::size_t sleepers(const World& world) {
    if (!world.has_resource<Sleep>()) return 0;
    const OverRanks ranks(world);
    const auto resting = world.column<Bodies, Resting>();
    std::size_t count = 0;
    for (Row b = 0; b < resting.size(); ++b)
        if (ranks.counts(b) && resting[b] >= world.resource<Sleep>().steps) ++count;
    ranks.add({&count});
    return count;
}

bool sleep_is_due(const World& world) {
    const Sleep& sleep = world.resource<Sleep>();
    return sleep.all || world.resource<Clock>().observed ||
           States(world, sleep).differ_from(sleep.states);
}

void review_sleep(World& world, Sleep& sleep) {
    const States now(world, sleep);
    const bool listed =
        world.resource<NearIndex<SpherePairs>>().awake.empty(); // new lists have no marks
    if (listed || now.differ_from(sleep.states)) {
        sleep.states = now.all();
        sleep.busy.resize(sleep.states.size());
        for (std::size_t b = 0; b < sleep.busy.size(); ++b)
            sleep.busy[b] = sleep.states[b] != Sleep::State::settled ? 1 : 0;
        mark_awake<SpherePairs>(world, sleep);
        mark_awake<PlanePairs>(world, sleep);
    }
    // new lists do not know yet which pairs touch, and observers read the forces of all pairs
    const bool all = sleep.all = listed || world.resource<Clock>().observed;
    mark_computed<SpherePairs>(world, sleep, all);
    mark_computed<PlanePairs>(world, sleep, all);
    leave_idle_rows(world, sleep, all);
}

} // namespace bris
