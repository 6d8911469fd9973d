#include "systems/fusion/spread.hpp"

#include "components/body.hpp"
#include "components/kinds.hpp"
#include "components/material.hpp"
#include "components/pair.hpp"
#include "components/sensor.hpp"
#include "components/sphere.hpp"
#include "engine/ordering.hpp"
#include "systems/fusion/correct.hpp"
#include "systems/fusion/spring_network.hpp"

#include <algorithm>
#include <span>
#include <tuple>
#include <vector>

namespace bris {

namespace {

/// A touching contact of a body.
struct Contact {
    Row partner;
    Vec3 point, normal;
    double kn, ks; ///< ks is 0 where it slips
};

/// All of one kind.
template <class Pairs> class ContactsOf {
public:
    explicit ContactsOf(const World& world) : laws_(world.resource<Materials>().linear_pairs) {
        if (!world.has<Pairs>() || world.resource<NearIndex<Pairs>>().size() == 0) return;
        index_ = &world.resource<NearIndex<Pairs>>();
        near_ = world.column<typename Pairs::Near, NearPair>();
        force_ = world.column<typename Pairs::Near, PairForce>();
        rows_ = world.column<Pairs, PairRows>();
        place_ = world.column<Listed, Place>();
        body_ = world.column<Listed, ListedBody>();
    }
    /// In the order of the force sums: whatever the rows, the same.
    template <class Visit> void visit(Row body, Visit&& visit) const {
        if (index_ == nullptr) return;
        index_->for_contacts_of(body, [&](Row k, bool as_partner) {
            const ForceRow& f = force_[k];
            const PlaceRow& sphere = place_[near_[k].owner];
            const LawRow& law = laws_[near_[k].law];
            Contact c{as_partner ? body_[near_[k].owner] : rows_[near_[k].pair].partner_body, Vec3(f.px, f.py, f.pz), Vec3::Zero(), law.kn, law.ks};
            c.normal = (Vec3(sphere.x, sphere.y, sphere.z) - c.point).normalized();
            const double slip = (Vec3(f.fx, f.fy, f.fz) - f.normal_force * c.normal).norm();
            if (slip >= 0.99 * law.friction * f.normal_force) c.ks = 0;
            visit(c);
        });
    }

private:
    std::span<const LawRow> laws_;
    const NearIndex<Pairs>* index_ = nullptr;
    std::span<const NearEntry> near_;
    std::span<const ForceRow> force_;
    std::span<const PairPlaces> rows_;
    std::span<const PlaceRow> place_;
    std::span<const Row> body_;
};

/// Free bodies that corrections have been given to, by id.
std::vector<Row> corrected_bodies(const World& world) {
    const auto row = rows_by_id(world.column<Bodies, BodyId>());
    const auto motion = world.column<Bodies, MotionOf>();
    const auto correction = world.column<Bodies, Correction>();
    const auto host = world.column<Sensors, SensorHost>();
    std::vector<EntityId> ids(host.begin(), host.end());
    std::ranges::sort(ids);
    std::vector<Row> bodies;
    for (const EntityId id : ids)
        if (motion[row[id]] == static_cast<std::uint32_t>(Motion::free) && correction[row[id]].steps > 0) bodies.push_back(row[id]);
    return bodies;
}

/// Adds to `bodies` all free ones that can be reached from them, contact by contact; the first are the nearest. Returns the contacts.
std::vector<Joint> joints_within_reach(const World& world, std::vector<Row>& bodies) {
    const std::tuple kinds{ContactsOf<SpherePairs>(world), ContactsOf<FacetPairs>(world), ContactsOf<PlanePairs>(world), ContactsOf<MembranePairs>(world)};
    const auto motion = world.column<Bodies, MotionOf>();
    const auto position = world.column<Bodies, Position>();
    constexpr std::uint32_t not_yet = that_stays - 1;
    std::vector<std::uint32_t> number(position.size(), not_yet);
    for (std::uint32_t i = 0; i < bodies.size(); ++i) number[bodies[i]] = i;
    std::vector<Joint> joints;
    for (std::uint32_t i = 0; i < bodies.size(); ++i) {
        const Row body = bodies[i];
        const auto reach = [&](const Contact& c) {
            std::uint32_t& other = number[c.partner];
            if (motion[c.partner] != static_cast<std::uint32_t>(Motion::free)) {
                other = that_stays;
            } else if (other == not_yet) {
                other = static_cast<std::uint32_t>(bodies.size());
                bodies.push_back(c.partner);
            }
            if (other < i || other == that_stays) joints.push_back({i, other, c.point - position[body], c.point - position[c.partner], c.normal, c.kn, c.ks});
        };
        std::apply([&](const auto&... kind) { (kind.visit(body, reach), ...); }, kinds);
    }
    return joints;
}

} // namespace

double spread_corrections(World& world, const SpreadSettings& settings) {
    std::vector<Row> bodies = corrected_bodies(world);
    if (bodies.empty()) return 0;
    const std::size_t corrected = bodies.size();
    SpringNetwork network{{}, joints_within_reach(world, bodies)};
    double mean_stiffness = 0;
    for (const Joint& j : network.joints) mean_stiffness += j.kn / static_cast<double>(network.joints.size());
    if (network.joints.empty()) mean_stiffness = 1; // any will do

    const auto correction = world.column<Bodies, Correction>();
    const auto guided = world.column<Bodies, Guided>();
    const auto radius = world.column<Bodies, BoundingRadius>();
    double steps = 0;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        const double arm2 = radius[bodies[i]] * radius[bodies[i]]; // makes a turn a length
        const CorrectionRow& c = correction[bodies[i]];
        Hold& hold = network.holds.emplace_back();
        hold.stiffness << Vec3::Constant(mean_stiffness), Vec3::Constant(mean_stiffness * arm2);
        if (i < corrected) {
            // both hold it: to where it is, and to where it should be
            const double both = settings.float_free + settings.hold;
            hold.wanted << c.steps * c.shift, c.steps * c.turn;
            hold.wanted *= settings.hold / both;
            hold.stiffness *= both;
            steps = std::max(steps, c.steps);
        } else hold.stiffness *= settings.float_free;
    }
    const auto u = motion_of_least_energy(network, settings.tolerance);
    for (std::size_t i = 0; i < bodies.size(); ++i)
        give_correction(correction[bodies[i]], guided[bodies[i]], u[i].head<3>(), u[i].tail<3>(), static_cast<unsigned>(steps));
    return energy_of_joints(network, u);
}

} // namespace bris
