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

/// Marks the pairs with a body that is awake, by the bits of their group. Pairs that fall asleep
/// are computed once more, and so are all pairs after the lists were made anew: from then on their
/// forces are those of bodies that do not move.
template <class Pairs>
void mark_awake(World& world, const std::vector<std::uint8_t>& sleeps) {
    if (!world.has<Pairs>()) return;
    auto& index = world.resource<NearIndex<Pairs>>();
    const PartnersOf<Pairs> partners(world);
    if (index.awake.empty())
        index.look.assign(index.touching.size(), 0xff);
    else
        index.look = index.awake;
    index.awake.assign(index.touching.size(), 0);
    for (std::size_t k = 0; k < index.size(); ++k) {
        const auto [owner, partner] = partners(k);
        const bool sleep = sleeps[owner] != 0 && sleeps[partner] != 0;
        index.awake[k / 8] =
            static_cast<std::uint8_t>(index.awake[k / 8] | (sleep ? 0u : 1u) << (k % 8));
    }
    for (std::size_t g = 0; g < index.look.size(); ++g) index.look[g] |= index.awake[g];
}

/// Marks the bodies with a pair that is computed in this step.
template <class Pairs>
void mark_busy(const World& world, std::vector<std::uint8_t>& busy) {
    if (!world.has<Pairs>()) return;
    const auto& index = world.resource<NearIndex<Pairs>>();
    const PartnersOf<Pairs> partners(world);
    const auto& look = index.look.empty() ? index.awake : index.look;
    for (std::size_t g = 0; g < look.size(); ++g)
        for (unsigned remaining = look[g]; remaining != 0; remaining &= remaining - 1) {
            const std::size_t k = 8 * g + static_cast<std::size_t>(__builtin_ctz(remaining));
            if (k >= index.size()) break; // past the last pair of its group
            const auto [owner, partner] = partners(k);
            busy[owner] = busy[partner] = 1;
        }
}

/// Lets row-local systems skip the rows of sleeping bodies without a contact that is computed.
void leave_idle_rows(World& world, const Sleep& sleep) {
    std::vector<std::uint8_t> busy(sleep.sleeps.size());
    std::ranges::transform(sleep.sleeps, busy.begin(),
                           [](std::uint8_t s) { return static_cast<std::uint8_t>(s == 0); });
    mark_busy<SpherePairs>(world, busy);
    mark_busy<PlanePairs>(world, busy);
    std::vector<std::uint8_t> idle((busy.size() + Table::idle_rows - 1) / Table::idle_rows, 1);
    for (std::size_t b = 0; b < busy.size(); ++b)
        if (busy[b] != 0) idle[b / Table::idle_rows] = 0;
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
    return sleep.again || WhoSleeps(world, sleep).differs_from(sleep.sleeps);
}

void review_sleep(World& world, Sleep& sleep) {
    const WhoSleeps who(world, sleep);
    const bool listed =
        world.resource<NearIndex<SpherePairs>>().awake.empty(); // new lists have no marks
    const bool changed = listed || who.differs_from(sleep.sleeps);
    if (changed) {
        sleep.sleeps = who.all();
        mark_awake<SpherePairs>(world, sleep.sleeps);
        mark_awake<PlanePairs>(world, sleep.sleeps);
    }
    leave_idle_rows(world, sleep);
    sleep.again = changed;
}

} // namespace bris
