#include "components/pair.hpp"
#include "components/sensor.hpp"
#include "components/settings.hpp"
#include "components/sphere.hpp"
#include "engine/errors.hpp"
#include "systems/sleep/sleep.hpp"

#include <algorithm>
#include <span>
#include <utility>

namespace bris {

namespace {

/// Which bodies sleep, by row. Fixed bodies always do.
class WhoSleeps {
public:
    WhoSleeps(const World& world, const Sleep& sleep)
        : motion_(world.column<Bodies, MotionOf>()), resting_(world.column<Bodies, Resting>()),
          steps_(sleep.steps) {}
    bool operator()(Row b) const {
        return motion_[b] == static_cast<std::uint32_t>(Motion::fixed) || resting_[b] >= steps_;
    }
    bool differs_from(const std::vector<std::uint8_t>& sleeps) const {
        if (sleeps.size() != motion_.size()) return true;
        unsigned differs = 0;
        for (Row b = 0; b < motion_.size(); ++b)
            differs |= static_cast<unsigned>((*this)(b)) ^ sleeps[b];
        return differs != 0;
    }
    std::vector<std::uint8_t> all() const {
        std::vector<std::uint8_t> sleeps(motion_.size());
        for (Row b = 0; b < motion_.size(); ++b) sleeps[b] = (*this)(b) ? 1 : 0;
        return sleeps;
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
/// that has just fallen asleep, since its dashpots no longer push.
template <class Pairs>
void mark_awake(World& world, Sleep& sleep, const std::vector<std::uint8_t>& slept) {
    if (!world.has<Pairs>()) return;
    auto& index = world.resource<NearIndex<Pairs>>();
    const auto is_new = [&](Row b) { return sleep.sleeps[b] == 0 || slept[b] == 0; };
    flag_pairs<Pairs>(world, index.awake, [&](Row owner, Row partner) {
        if (is_new(owner) || is_new(partner)) sleep.busy[owner] = sleep.busy[partner] = 1;
        return sleep.sleeps[owner] == 0 || sleep.sleeps[partner] == 0;
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
        !world.has<Facets>() && !world.has<Elements>(),
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
    return static_cast<std::size_t>(
        std::ranges::count_if(world.column<Bodies, Resting>(),
                              [&](std::uint32_t r) { return r >= world.resource<Sleep>().steps; }));
}

bool sleep_is_due(const World& world) {
    const Sleep& sleep = world.resource<Sleep>();
    return sleep.all || sleep.fell_asleep || world.resource<Clock>().observed ||
           WhoSleeps(world, sleep).differs_from(sleep.sleeps);
}

void review_sleep(World& world, Sleep& sleep) {
    const WhoSleeps who(world, sleep);
    const bool listed =
        world.resource<NearIndex<SpherePairs>>().awake.empty(); // new lists have no marks
    if (listed || sleep.fell_asleep || who.differs_from(sleep.sleeps)) {
        std::vector<std::uint8_t> slept = who.all();
        if (sleep.sleeps.size() != slept.size()) sleep.sleeps = slept;
        std::swap(slept, sleep.sleeps);
        sleep.fell_asleep = slept != sleep.sleeps;
        sleep.busy.resize(slept.size());
        for (std::size_t b = 0; b < slept.size(); ++b)
            sleep.busy[b] = slept[b] == 0 || sleep.sleeps[b] == 0 ? 1 : 0;
        mark_awake<SpherePairs>(world, sleep, slept);
        mark_awake<PlanePairs>(world, sleep, slept);
    }
    // new lists do not know yet which pairs touch, and observers read the forces of all pairs
    const bool all = sleep.all = listed || world.resource<Clock>().observed;
    mark_computed<SpherePairs>(world, sleep, all);
    mark_computed<PlanePairs>(world, sleep, all);
    leave_idle_rows(world, sleep, all);
}

} // namespace bris
